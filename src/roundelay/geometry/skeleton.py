"""The skeleton: a tree of joints with their offsets, checked once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import as_numbers, as_sequence
from roundelay.base.errors import SkeletonMismatch
from roundelay.geometry.figure import Figure

__all__ = ["Skeleton"]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Describe a tree of joints at rest.

    Parameters
    ----------
    names : tuple of str
        One name a joint, all different; the root comes first.
    parents : tuple of int
        Index of each joint's parent, smaller than its own; -1 for the root.
    offsets : (J, 3) ndarray
        Each joint's position relative to its parent at rest, in the file's length unit.
    end_sites : tuple of (int, (3,) ndarray)
        Ends of limbs: the joint they hang on and their offset from it.
    layout : object, optional
        How the file it was read from writes this skeleton (channel orders, axes); used by
        that format's writer only.
    free : bool
        Whether the joints are points that move freely against each other: markers or keypoints.
        The root is then the frame of the trunk and no point, and bones are lines to draw.
    figure : Figure, optional
        The meshes that hang on the joints, which are written to glTF.
    rest : (J, 4) ndarray, optional
        Local rotations at rest, where a file has them; else joints at rest are not turned.

    Raises
    ------
    ValueError
        If the parts do not make a tree.

    Examples
    --------
    >>> offsets = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0]])
    >>> arm = rl.Skeleton(("shoulder", "elbow"), (-1, 0), offsets)
    >>> arm.n_joints, arm.size
    (2, 0.3)
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: NDArray[np.float64]
    end_sites: tuple[tuple[int, NDArray[np.float64]], ...] = ()
    layout: Any = field(default=None, repr=False)
    free: bool = False
    figure: Figure | None = field(default=None, repr=False)
    rest: NDArray[np.float64] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        offsets = np.array(as_numbers(self.offsets, "offsets (J, 3)"), float)
        offsets.flags.writeable = False
        object.__setattr__(self, "offsets", offsets)
        n = len(as_sequence(self.names, "names"))
        if n == 0 or len(as_sequence(self.parents, "parents")) != n or offsets.shape != (n, 3):
            raise ValueError(
                "expected as many parents and offsets as names, at least one; found "
                f"{n} names, {len(self.parents)} parents, offsets of shape {offsets.shape}"
            )
        if len(set(self.names)) != n:
            raise ValueError("expected joint names to be different")
        if self.parents[0] != -1 or any(not 0 <= p < i for i, p in enumerate(self.parents) if i):
            raise ValueError("expected one root, first, and every parent before its children")
        if not np.all(np.isfinite(offsets)):
            raise ValueError("expected finite offsets")
        if any(not 0 <= joint < n for joint, _ in self.end_sites):
            raise ValueError("expected every end site on a joint of the skeleton")

    def __repr__(self) -> str:
        return f"Skeleton({self.n_joints} joints, root {self.names[0]!r})"

    @property
    def n_joints(self) -> int:
        """Number of joints, root included, end sites not."""
        return len(self.names)

    @cached_property
    def levels(self) -> tuple[NDArray[np.intp], ...]:
        """Joints by depth: the root alone first, then its children, and so on."""
        depth = [0] * self.n_joints
        for joint, parent in enumerate(self.parents[1:], 1):
            depth[joint] = depth[parent] + 1
        return tuple(np.flatnonzero(np.equal(depth, d)) for d in range(max(depth) + 1))

    @cached_property
    def trunk(self) -> tuple[int, ...]:
        """Joints from the root to the first with several children; the root alone if none has."""
        children = np.bincount(np.array(self.parents[1:], np.intp), minlength=self.n_joints)
        chain = [0]
        while children[chain[-1]] == 1:
            chain.append(self.parents.index(chain[-1]))
        return tuple(chain) if children[chain[-1]] else (0,)

    @cached_property
    def bone_lengths(self) -> NDArray[np.float64]:
        """Length (J,) of the bones that hang on each joint (children and end sites), summed."""
        lengths = np.zeros(self.n_joints)
        for joint, parent in enumerate(self.parents[1:], 1):
            lengths[parent] += np.linalg.norm(self.offsets[joint])
        for joint, offset in self.end_sites:
            lengths[joint] += np.linalg.norm(offset)
        return lengths

    @cached_property
    def moved_lengths(self) -> NDArray[np.float64]:
        """Length (J,) of all bones that a joint moves, its own and those below: as their mass."""
        lengths = self.bone_lengths.copy()
        for joint in range(self.n_joints - 1, 0, -1):
            lengths[self.parents[joint]] += lengths[joint]
        return lengths

    @cached_property
    def reaches(self) -> NDArray[np.float64]:
        """How far from each joint (J,) what hangs on it goes, along bones."""
        reach = np.zeros(self.n_joints)
        for joint, offset in self.end_sites:
            reach[joint] = max(reach[joint], float(np.linalg.norm(offset)))
        for joint in range(self.n_joints - 1, 0, -1):
            below = reach[joint] + float(np.linalg.norm(self.offsets[joint]))
            reach[self.parents[joint]] = max(reach[self.parents[joint]], below)
        return reach

    @cached_property
    def size(self) -> float:
        """The longest path along bones between two ends: a size no pose changes.

        About 1.1 times a person's height; 1 for a skeleton with no length at all.
        """
        down = np.zeros(self.n_joints)
        for joint, offset in self.end_sites:
            down[joint] = max(down[joint], float(np.linalg.norm(offset)))
        longest = float(down.max())
        for joint in range(self.n_joints - 1, 0, -1):
            parent = self.parents[joint]
            reach = down[joint] + float(np.linalg.norm(self.offsets[joint]))
            longest = max(longest, down[parent] + reach)
            down[parent] = max(down[parent], reach)
        return float(longest) or 1.0

    def index(self, name: str) -> int:
        """Return the index of a joint.

        Raises
        ------
        SkeletonMismatch
            If there is no such joint; the message lists those there are.
        """
        try:
            return self.names.index(name)
        except ValueError:
            known = ", ".join(self.names)
            raise SkeletonMismatch(f"no joint {name!r}; the joints are {known}") from None

    def indices(self, names: Iterable[str]) -> NDArray[np.intp]:
        """Return the indices of several joints, as `index` does for one."""
        return np.array([self.index(name) for name in names], dtype=np.intp)

    def descendants(self, joint: int) -> list[int]:
        """Return a joint and all below it, in order."""
        found = {joint}
        for other in range(joint + 1, self.n_joints):
            if self.parents[other] in found:
                found.add(other)
        return sorted(found)

    def scaled(self, factor: float) -> Skeleton:
        """Return the skeleton with every length multiplied by `factor`."""
        ends = tuple((joint, offset * factor) for joint, offset in self.end_sites)
        figure = self.figure and self.figure.scaled(factor)
        return replace(self, offsets=self.offsets * factor, end_sites=ends, figure=figure)

    def require_same(self, other: Skeleton) -> None:
        """Check that another skeleton has the same joints in the same tree.

        Raises
        ------
        SkeletonMismatch
            Naming the joints that only one of them has, or the first that hangs elsewhere.
        """
        if self.names == other.names and self.parents == other.parents:
            return
        ours, theirs = set(self.names), set(other.names)
        if ours != theirs:
            raise SkeletonMismatch(
                f"joints only in the first: {_listed(ours - theirs)}; "
                f"only in the second: {_listed(theirs - ours)}"
            )
        raise SkeletonMismatch("the same joints, but in another order or on other parents")


def _listed(names: Sequence[str] | set[str]) -> str:
    return ", ".join(sorted(names)) or "none"
