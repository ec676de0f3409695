"""Trees of nodes, as scenes hold them: which of them are the skeleton's joints, and in what order.

A scene of glTF or FBX is a tree of nodes of all kinds. The joints of a skeleton are those that are
marked as such, and what lies between them.
"""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from roundelay.base.errors import FormatError, RoundelayWarning
from roundelay.formats.sane import MOST_JOINTS

__all__ = ["Tree", "called", "different", "listed", "note"]

# Names in a note.
_NAMED = 8


@dataclass(frozen=True)
class Tree:
    """The nodes of a scene.

    Parameters
    ----------
    path : Path
        The file, for errors and notes.
    names : list of str
    parents : list of int
        The parent of each node; -1 for none.
    order : list of int
        All nodes, parents first.
    """

    path: Path
    names: list[str]
    parents: list[int]
    order: list[int]

    @classmethod
    def of(cls, path: Path, names: list[str], parents: list[int]) -> Tree:
        """Make a tree of nodes and their parents.

        Raises
        ------
        FormatError
            If a node lies below itself.
        """
        children: list[list[int]] = [[] for _ in parents]
        for node, parent in enumerate(parents):
            if parent >= 0:
                children[parent].append(node)
        order = [node for node, parent in enumerate(parents) if parent < 0]
        for node in order:  # it grows
            order.extend(children[node])
        if len(order) < len(parents):
            circle = min(set(range(len(parents))) - set(order))
            told = f"expected a tree of nodes, found node {names[circle]!r} below itself"
            raise FormatError(told, path=path)
        return cls(path, names, parents, order)

    def above(self, node: int) -> Iterator[int]:
        """Return the nodes above one, from the top."""
        chain = []
        while (node := self.parents[node]) >= 0:
            chain.append(node)
        return reversed(chain)

    def counted(self, chosen: Collection[int]) -> list[int]:
        """Count for every node the chosen ones among it and those below it."""
        below = [int(node in chosen) for node in range(len(self.parents))]
        for node in reversed(self.order):
            if self.parents[node] >= 0:
                below[self.parents[node]] += below[node]
        return below

    def with_descendants(self, nodes: Collection[int]) -> set[int]:
        """Return nodes and all that hang on them."""
        found = set(nodes)
        for node in self.order:
            if self.parents[node] in found:
                found.add(node)
        return found

    def roots(self, chosen: set[int]) -> dict[str, int]:
        """Return the root joint of every skeleton by its name, the largest skeleton first.

        A skeleton is a chosen node that lies below no other, and all below it.
        """
        tops, under = set[int](), set[int]()
        for node in self.order:
            if self.parents[node] in under:
                under.add(node)
            elif node in chosen:
                tops.add(node)
                under.add(node)
        below = self.counted(chosen)
        ranked = sorted(tops, key=lambda node: (-below[node], node))
        return dict(zip(different([self.names[node] for node in ranked]), ranked, strict=True))

    def connected(self, chosen: set[int]) -> list[int]:
        """Return chosen nodes and those that join them, parents first, in the file's order if so.

        Of several trees the one with the most of them is taken, with a note.

        Raises
        ------
        FormatError
            If there are more than any body has.
        """
        below = self.counted(chosen)
        tops = [node for node in self.order if self.parents[node] < 0 and below[node]]
        top = max(tops, key=lambda node: below[node])
        if len(tops) > 1:
            told = f"of {len(tops)} trees of joints, that below {self.names[top]!r} is read"
            note(self.path, f"{told} (--character names another)")
        joints = [self._lowest_above_all(chosen, below, top)]
        inside = set(joints)
        for node in self.order:
            if self.parents[node] in inside and below[node]:
                inside.add(node)
                joints.append(node)
        return self._in_order(joints)

    def _lowest_above_all(self, chosen: set[int], below: list[int], top: int) -> int:
        """Return the lowest node that has all chosen ones of a tree at or below it."""
        lowest = top
        for node in self.order:
            if lowest in chosen:
                break
            if self.parents[node] == lowest and below[node] == below[top]:
                lowest = node
        return lowest

    def _in_order(self, joints: list[int]) -> list[int]:
        if len(joints) > MOST_JOINTS:
            told = f"expected at most {MOST_JOINTS} joints, found {len(joints)}"
            raise FormatError(told, path=self.path)
        by_number = sorted(joints)
        first = by_number[0] == joints[0]
        ordered = first and all(self.parents[node] < node for node in by_number[1:])
        return by_number if ordered else joints

    def without_ends(
        self, joints: Sequence[int], moving: Collection[int]
    ) -> tuple[list[int], list[tuple[int, int]]]:
        """Part the joints from the ends of limbs: NAME_end below NAME, which never moves.

        Parameters
        ----------
        joints : sequence of int
        moving : collection of int
            Nodes that an animation moves.

        Returns
        -------
        joints : list of int
        ends : list of (int, int)
            Each with the joint that it hangs on.
        """
        holding = {self.parents[joint] for joint in joints}
        fixed = [joint for joint in joints[1:] if joint not in holding and joint not in moving]
        ends = [
            (self.parents[joint], joint)
            for joint in fixed
            if self.names[joint] == f"{self.names[self.parents[joint]]}_end"
        ]
        left_out = {end for _, end in ends}
        return [joint for joint in joints if joint not in left_out], ends


def different(names: Sequence[str]) -> tuple[str, ...]:
    """Return names, each with a number behind it that an earlier one has already."""
    found: dict[str, None] = {}
    counts: dict[str, int] = {}
    for name in names:
        unlike = name
        while unlike in found:
            counts[name] = counts.get(name, 1) + 1
            unlike = f"{name}_{counts[name]}"
        found[unlike] = None
    return tuple(found)


def called(what: str, names: Sequence[str], wanted: str, path: Path) -> int:
    """Return the number of what is wanted by its name.

    Raises
    ------
    FormatError
        If there is nothing of that name; the message lists those there are.
    """
    if wanted in names:
        return names.index(wanted)
    there = listed([repr(name) for name in names]) or "none"
    raise FormatError(f"expected {what} among {there}, found {wanted!r}", path=path)


def listed(names: Sequence[str]) -> str:
    """Return the first of some names as a text."""
    return ", ".join(names[:_NAMED]) + (", ..." if len(names) > _NAMED else "")


def note(path: Path, text: str) -> None:
    """Say that a file is used, but not all of it or not as it is."""
    warnings.warn(f"{path}: {text}", RoundelayWarning, stacklevel=2)
