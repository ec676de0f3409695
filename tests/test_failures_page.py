"""The page of failures: what it quotes is what the program says."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SOURCE = " ".join(path.read_text() for path in (ROOT / "src" / "roundelay").rglob("*.py"))
# Strings are broken where a line ends.
SOURCE = re.sub(r'"\s*f?"', "", SOURCE)


def _quoted():
    for line in (ROOT / "docs" / "failures.md").read_text().splitlines():
        if line.startswith("| `"):
            yield from re.findall(r"`([^`]+)`", line.split("|")[1])


@pytest.mark.parametrize("message", sorted(_quoted()))
def test_messages_are_those_of_the_program(message):
    for piece in re.split(r"\d+%?", message):
        assert piece.strip(" .") in SOURCE


def test_options_are_those_of_the_program():
    flags = set(re.findall(r"`(--[a-z-]+)", (ROOT / "docs" / "failures.md").read_text()))
    known = (ROOT / "src" / "roundelay").rglob("*.py")
    told = " ".join(path.read_text() for path in known).replace("_", "-")
    assert len(flags) > 10
    assert [flag for flag in sorted(flags) if flag[2:].removeprefix("no-") not in told] == []
