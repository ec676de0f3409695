"""Random choices of the fuzzer, some of which are wild, and text in odd encodings."""

from __future__ import annotations

import random

__all__ = ["Chance", "Files", "encoded"]

Files = dict[str, bytes]
"""The files of a capture by their names; the first one is read."""

_WORDS = [
    "nan",
    "inf",
    "-inf",
    "1e999",
    "1_0",
    "0x1F",
    "--",
    "+",
    ".",
    "-",
    "1.",
    ".5",
    "-.5",
    "+3",
    "1e5",
    "1E-5",
    "1e-320",
    "9e99",
    "1e13",
    "99999999999999999",
    "{",
    "}",
    "JOINT",
    "ROOT",
    "End",
    "Site",
    "OFFSET",
    "CHANNELS",
    "MOTION",
    "Frames:",
    "Frame",
    "Time:",
    "//",
    "#",
    "begin",
    "end",
    "root",
    "dof",
]
_NAMES = ["Hips", "left leg", "é", "a:b", "x#y", "=1", "歩", "\x1b[1m", "\u202e", "n" * 300, "Site"]
_BLANKS = (" ", "  ", "\t", "\n", "\r\n", " # note\n")


class Chance(random.Random):
    """Random choices, some of which are wild."""

    wild = 0.0

    def is_wild(self) -> bool:
        return self.random() < self.wild

    def number(self, size: float = 100.0) -> str:
        if self.is_wild():
            return self.choice(_WORDS)
        value = self.uniform(-size, size)
        return self.choice((f"{value:.4f}", f"{value:g}", f"{value:.0f}", "0", f"{value:e}"))

    def numbers(self, count: int, size: float = 100.0) -> str:
        count += self.choice((-1, 1)) if self.is_wild() else 0
        return " ".join(self.number(size) for _ in range(max(0, count)))

    def name(self, number: int) -> str:
        return self.choice(_NAMES) if self.is_wild() else f"joint{number}"

    def word(self, word: str) -> str:
        if self.is_wild():
            return self.choice((word.lower(), word[:-1], word * 2, "", self.choice(_WORDS)))
        return word

    def count(self, number: int) -> int:
        return max(0, number + self.choice((-1, 1, 1000, 10**12))) if self.is_wild() else number

    def blank(self) -> str:
        return self.choice(_BLANKS) if self.is_wild() else "\n"

    def tree(self, most: int) -> list[int]:
        """Parents of joints, each before its children."""
        return [-1] + [self.randrange(joint) for joint in range(1, self.randint(1, most))]


def encoded(chance: Chance, text: str) -> bytes:
    data = text.encode("utf-8", "surrogatepass")
    if chance.is_wild():
        data = chance.choice(
            (b"\xef\xbb\xbf" + data, text.encode("utf-16"), data + b"\x00", data[:-9])
        )
    return data
