"""The hierarchy of a Biovision file (BVH): its joints, and the layout of their channels."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from roundelay.formats.euler import Winding
from roundelay.formats.text import Cursor, Token
from roundelay.geometry.skeleton import Skeleton

__all__ = ["BvhLayout", "read_hierarchy"]

_MAX_DEPTH = 256
_CHANNELS = {axis + kind for axis in "xyz" for kind in ("position", "rotation")}


@dataclass(frozen=True)
class BvhLayout:
    """Hold how a BVH file writes its skeleton.

    Parameters
    ----------
    channels : tuple of tuple of str
        Each joint's channels in the file's order and spelling.
    end_sites : tuple of str
        The spelling of each end site's heading.
    windings : tuple of {"principal", "positive", "continuous"}
        Which of the equivalent angles each joint's channels give; see `euler.Winding`.
    """

    channels: tuple[tuple[str, ...], ...]
    end_sites: tuple[str, ...] = ()
    windings: tuple[Winding, ...] = ()

    @property
    def orders(self) -> tuple[str, ...]:
        """Axes of each joint's rotation channels, as in "ZYX"."""
        return tuple(_axes(names, "rotation") for names in self.channels)

    @property
    def placed(self) -> tuple[str, ...]:
        """Axes of each joint's position channels."""
        return tuple(_axes(names, "position") for names in self.channels)

    def columns(self, kind: str) -> list[list[int]]:
        """Return the columns of each joint's "rotation" or "position" channels."""
        result, column = [], 0
        for names in self.channels:
            own = [column + i for i, name in enumerate(names) if name.lower().endswith(kind)]
            result.append(own)
            column += len(names)
        return result

    @property
    def width(self) -> int:
        """Numbers in a frame."""
        return sum(map(len, self.channels))


def _axes(channels: tuple[str, ...], kind: str) -> str:
    return "".join(name[0].upper() for name in channels if name.lower().endswith(kind))


def read_hierarchy(cursor: Cursor) -> Skeleton:
    """Read the tree of joints, from HIERARCHY to the last brace.

    Raises
    ------
    FormatError
        If it is not whole.
    """
    return _Hierarchy(cursor).read()


@dataclass
class _Node:
    """A joint or end site being read: its index in its own list, and what it still lacks."""

    joint: int
    is_end: bool
    at: int
    lacks: set[str] = field(default_factory=lambda: {"OFFSET", "CHANNELS"})


class _Hierarchy:
    """Read the tree of joints without recursion."""

    def __init__(self, cursor: Cursor) -> None:
        self.cursor = cursor
        self.names: dict[str, int] = {}
        self.parents: list[int] = []
        self.offsets: list[list[float]] = []
        self.channels: list[tuple[str, ...]] = []
        self.ends: list[tuple[int, list[float]]] = []
        self.spellings: list[str] = []
        self.open: list[_Node] = []

    def read(self) -> Skeleton:
        self.cursor.keyword("HIERARCHY")
        root = self.cursor.keyword("ROOT")
        self._joint(root)
        while self.open:
            self._entry()
        layout = BvhLayout(tuple(self.channels), tuple(self.spellings))
        ends = tuple((joint, np.array(offset)) for joint, offset in self.ends)
        offsets = np.array(self.offsets)
        return Skeleton(tuple(self.names), tuple(self.parents), offsets, ends, layout)

    def _entry(self) -> None:
        expected = "OFFSET, CHANNELS, JOINT, End Site or }"
        token = self.cursor.next(expected)
        entries = {
            "offset": self._offset,
            "channels": self._channels,
            "joint": self._joint,
            "end": self._end_site,
            "endsite": self._end_site,
            "end_site": self._end_site,
            "}": self._close,
        }
        try:
            entry = entries[token.text.lower()]
        except KeyError:
            raise self.cursor.found(expected, token) from None
        entry(token)

    def _joint(self, token: Token) -> None:
        self._check_place(token)
        name = self.cursor.line()
        if not name.text:
            raise self.cursor.found("a joint's name", self.cursor.next("a joint's name"))
        if name.text in self.names:
            raise self.cursor.found("a joint's name not used before", name)
        self.parents.append(self.open[-1].joint if self.open else -1)
        self.names[name.text] = len(self.names)
        self.offsets.append([])
        self.channels.append(())
        self._push(_Node(len(self.parents) - 1, False, token.at))

    def _end_site(self, token: Token) -> None:
        self._check_place(token)
        self.spellings.append(f"{token.text} {self.cursor.line().text}".strip())
        self.ends.append((self.open[-1].joint, []))
        self._push(_Node(len(self.ends) - 1, True, token.at, {"OFFSET"}))

    def _check_place(self, token: Token) -> None:
        if self.open and self.open[-1].is_end:
            raise self.cursor.found("OFFSET or } in an end site", token)

    def _push(self, node: _Node) -> None:
        self.cursor.keyword("{")
        self.open.append(node)
        if len(self.open) > _MAX_DEPTH:
            raise self.cursor.source.error(
                f"expected joints at most {_MAX_DEPTH} deep, found deeper", node.at
            )

    def _settle(self, what: str, token: Token) -> _Node:
        node = self.open[-1]
        if what not in node.lacks:
            raise self.cursor.found(f"no further {what} here", token)
        node.lacks.remove(what)
        return node

    def _offset(self, token: Token) -> None:
        node = self._settle("OFFSET", token)
        offset = [self.cursor.number("three numbers after OFFSET") for _ in "xyz"]
        (self.ends[node.joint][1] if node.is_end else self.offsets[node.joint]).extend(offset)

    def _channels(self, token: Token) -> None:
        node = self._settle("CHANNELS", token)
        count = self.cursor.next("a number of channels")
        if count.text not in tuple("0123456"):
            raise self.cursor.found("a number of channels from 0 to 6", count)
        for _ in range(int(count.text)):
            self._channel(node.joint)

    def _channel(self, joint: int) -> None:
        token = self.cursor.next("a channel")
        if token.text.lower() not in _CHANNELS:
            raise self.cursor.found("a channel like Xposition or Zrotation", token)
        if token.text.lower() in {name.lower() for name in self.channels[joint]}:
            raise self.cursor.found("each channel once", token)
        self.channels[joint] += (token.text,)

    def _close(self, token: Token) -> None:
        node = self.open.pop()
        if node.lacks:
            raise self.cursor.found(" and ".join(sorted(node.lacks)) + " before", token)
