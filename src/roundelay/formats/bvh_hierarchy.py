"""The hierarchy of a Biovision file (BVH): its joints, and the layout of their channels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from roundelay.formats.euler import Winding
from roundelay.formats.nodes import different, listed
from roundelay.formats.text import Cursor, Token
from roundelay.geometry.skeleton import Skeleton

__all__ = ["BvhLayout", "Hierarchy", "read_hierarchies"]

_MAX_DEPTH = 256
_CHANNELS = {axis + kind for axis in "xyz" for kind in ("position", "rotation", "scale")}


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


@dataclass(frozen=True)
class Hierarchy:
    """Hold one skeleton of a file, and where its channels stand among all.

    Parameters
    ----------
    skeleton : Skeleton
    columns : tuple of int
        Of the channels that the skeleton's layout names, counted from its first.
    width : int
        Channels that the file names, those of scales and of end sites, too.
    at_ends : tuple of int
        Of the channels of end sites, which some programs name and do not write.
    at : int
        Byte offset of its root.
    notes : tuple of str
        What was read otherwise than it stands there.
    """

    skeleton: Skeleton
    columns: tuple[int, ...]
    width: int
    at_ends: tuple[int, ...]
    at: int
    notes: tuple[str, ...] = ()


def read_hierarchies(cursor: Cursor) -> list[Hierarchy]:
    """Read the trees of joints, from HIERARCHY to the last brace: one, or several.

    Raises
    ------
    FormatError
        If one is not whole.
    """
    cursor.keyword("HIERARCHY")
    found = [_Hierarchy(cursor).read()]
    while cursor.follows("ROOT", "HIERARCHY"):
        if cursor.follows("HIERARCHY"):
            cursor.keyword("HIERARCHY")
        found.append(_Hierarchy(cursor).read())
    return found


@dataclass
class _Node:
    """A joint or end site being read: its index in its own list and among all, what it lacks."""

    joint: int
    is_end: bool
    at: int
    slot: int
    lacks: set[str] = field(default_factory=lambda: {"OFFSET", "CHANNELS"})


class _Hierarchy:
    """Read the tree of joints without recursion."""

    def __init__(self, cursor: Cursor) -> None:
        self.cursor = cursor
        self.names: list[str] = []
        self.parents: list[int] = []
        self.offsets: list[list[float]] = []
        self.channels: list[tuple[str, ...]] = []
        self.ends: list[tuple[int, list[float]]] = []
        self.spellings: list[str] = []
        self.open: list[_Node] = []
        # All channels as the file names them, in its order; those of an end site have no joint.
        self.named: list[tuple[int, list[str]]] = []

    def read(self) -> Hierarchy:
        root = self.cursor.keyword("ROOT")
        self._joint(root)
        while self.open:
            self._entry()
        layout = BvhLayout(tuple(self.channels), tuple(self.spellings))
        ends = tuple((joint, np.array(offset)) for joint, offset in self.ends)
        offsets, names = np.array(self.offsets), different(self.names)
        skeleton = Skeleton(names, tuple(self.parents), offsets, ends, layout)
        every = [(joint, name) for joint, held in self.named for name in held]
        columns = [n for n, (joint, name) in enumerate(every) if joint >= 0 and not _scales(name)]
        at_ends = [n for n, (joint, _) in enumerate(every) if joint < 0]
        notes = tuple(self._notes(names))
        return Hierarchy(skeleton, tuple(columns), len(every), tuple(at_ends), root.at, notes)

    def _notes(self, names: tuple[str, ...]) -> Iterator[str]:
        twins = [repr(new) for old, new in zip(self.names, names, strict=True) if old != new]
        if twins:
            yield f"joints of one name are told apart as {listed(twins)}"
        if any(_scales(name) for _, held in self.named for name in held):
            yield "scale channels are left out"

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
        self.parents.append(self.open[-1].joint if self.open else -1)
        self.names.append(name.text)
        self.offsets.append([])
        self.channels.append(())
        self._push(_Node(len(self.parents) - 1, False, token.at, len(self.named)))

    def _end_site(self, token: Token) -> None:
        self._check_place(token)
        self.spellings.append(f"{token.text} {self.cursor.line().text}".strip())
        self.ends.append((self.open[-1].joint, []))
        self._push(_Node(len(self.ends) - 1, True, token.at, len(self.named)))

    def _check_place(self, token: Token) -> None:
        if self.open and self.open[-1].is_end:
            raise self.cursor.found("OFFSET or } in an end site", token)

    def _push(self, node: _Node) -> None:
        self.cursor.keyword("{")
        self.named.append((-1, []))
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
        if count.text not in tuple("0123456789"):
            raise self.cursor.found("a number of channels from 0 to 9", count)
        held: list[str] = []
        for _ in range(int(count.text)):
            held.append(self._channel(held))
        self.named[node.slot] = (-1 if node.is_end else node.joint, held)
        if not node.is_end:
            self.channels[node.joint] = tuple(name for name in held if not _scales(name))

    def _channel(self, held: list[str]) -> str:
        token = self.cursor.next("a channel")
        if token.text.lower() not in _CHANNELS:
            raise self.cursor.found("a channel like Xposition or Zrotation", token)
        if token.text.lower() in {name.lower() for name in held}:
            raise self.cursor.found("each channel once", token)
        return token.text

    def _close(self, token: Token) -> None:
        node = self.open.pop()
        node.lacks -= {"CHANNELS"} if node.is_end else set()
        if node.lacks:
            raise self.cursor.found(" and ".join(sorted(node.lacks)) + " before", token)


def _scales(channel: str) -> bool:
    return channel.lower().endswith("scale")
