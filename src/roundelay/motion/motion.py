"""A motion: a skeleton, its joints' rotations over time, and the path of its root."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import all_expected, as_number, as_numbers, expected
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import (
    lateral_axis,
    partners,
    reflected_rotations,
    reflected_skeleton,
    reflection,
)
from roundelay.motion.thresholds import POSES

__all__ = ["FASTEST", "Motion", "checked_rate", "concatenate"]

Array = NDArray[np.float64]

# Frames a second; none is shown or filmed faster, and a slip of the keyboard would fill memory.
FASTEST = 10_000.0
# Frames looked at together.
_BLOCK = 4096


@dataclass(frozen=True, eq=False)
class Motion:
    """Hold the poses of a skeleton at a constant frame rate.

    Parameters
    ----------
    skeleton : Skeleton
    rotations : (F, J, 4) array_like
        Local rotations as unit quaternions (w, x, y, z); made continuous in sign over time.
    root_path : (F, 3) array_like
        Position of the root in the skeleton's length unit.
    frame_time : float
        Seconds from one frame to the next.
    translations : (F, J, 3) array_like, optional
        Joint positions relative to their parents, for captures whose bones change length;
        the skeleton's offsets by default. The root's column is not used.
    name : str
        A name for people: by default the file's.
    up : {0, 1, 2}
        The axis that points up; Y (1) unless the file's poses say otherwise.
    missing : (F, J) array_like of bool, optional
        Joints that were not seen and could not be told from the rest; None if all were.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, or the frame time is not positive.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> walk
    Motion('walk', 429 frames at 60 fps, 19 joints)
    >>> walk[30:60].positions().shape
    (30, 19, 3)
    """

    skeleton: Skeleton
    rotations: Array
    root_path: Array
    frame_time: float
    translations: Array | None = None
    name: str = ""
    up: int = 1
    missing: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        joints = expected(Skeleton, self.skeleton).n_joints
        rotations = np.asarray(as_numbers(self.rotations, "rotations"), float)
        path = np.asarray(as_numbers(self.root_path, "root_path"), float)
        frames = len(path) if path.ndim else 0
        _check_shape("rotations", rotations, (frames, joints, 4))
        _check_shape("root_path", path, (frames, 3))
        if not (np.isfinite(as_number(self.frame_time, "frame time")) and self.frame_time > 0.0):
            raise ValueError(f"expected a positive frame time, found {self.frame_time}")
        object.__setattr__(self, "rotations", _frozen(_continuous(rotations)))
        object.__setattr__(self, "root_path", _frozen(_own(path)))
        if self.translations is not None:
            moved = np.asarray(as_numbers(self.translations, "translations"), float)
            _check_shape("translations", moved, (frames, joints, 3))
            object.__setattr__(self, "translations", _frozen(_own(moved)))
        if self.missing is not None:
            missing = np.array(self.missing, bool)
            if missing.shape != (frames, joints):
                told = f"({frames}, {joints}), found {missing.shape}"
                raise ValueError(f"expected missing of shape {told}")
            object.__setattr__(self, "missing", _frozen(missing) if missing.any() else None)

    def __len__(self) -> int:
        return len(self.root_path)

    def __repr__(self) -> str:
        joints = self.skeleton.n_joints
        return f"Motion({self.name!r}, {len(self)} frames at {self.fps:.4g} fps, {joints} joints)"

    def __getitem__(self, frames: slice) -> Motion:
        """Return a half-open range of frames, ``motion[start:stop]``."""
        if not isinstance(frames, slice) or frames.step not in (None, 1):
            raise TypeError("expected a slice of frames without step, motion[start:stop]")
        return self._with_frames(frames)

    @property
    def shown(self) -> NDArray[np.bool_]:
        """Frames (F,) in which enough of the joints are known to see the body."""
        if self.missing is None:
            return np.ones(len(self), bool)
        return np.asarray(self.missing.mean(axis=1) <= 1.0 - POSES.shown)

    @property
    def n_frames(self) -> int:
        """Number of frames."""
        return len(self)

    @property
    def up_vector(self) -> Array:
        """The unit vector (3,) that points up."""
        return np.eye(3)[self.up]

    @property
    def fps(self) -> float:
        """Frames per second."""
        return 1.0 / self.frame_time

    @property
    def duration(self) -> float:
        """Seconds covered: the number of frames times the frame time."""
        return len(self) * self.frame_time

    def positions(self) -> Array:
        """Return the joints' global positions (F, J, 3) in the skeleton's length unit."""
        return forward_kinematics(
            self.skeleton, self.rotations, self.root_path, translations=self.translations
        )[0]

    def resample(self, fps: float) -> Motion:
        """Return the motion at another frame rate.

        Rotations are interpolated along great arcs, positions linearly; the first frame
        stays, and the last is the last that does not pass the motion's end.

        Raises
        ------
        ValueError
            If `fps` is not positive, or beyond 10,000.
        """
        ratio = 1.0 / (checked_rate(fps) * self.frame_time)
        # A grid point that rounding puts just past the end belongs to the motion.
        count = int(np.floor((len(self) - 1) / ratio + 1e-6)) + 1
        return replace(self.at(np.arange(count) * ratio), frame_time=1.0 / fps)

    def at(self, frames: ArrayLike) -> Motion:
        """Return poses at fractional frames (n,), interpolated; the frame time stays."""
        where = np.clip(np.asarray(frames, float), 0.0, len(self) - 1)
        before = np.minimum(where.astype(int), max(len(self) - 2, 0))
        after = np.minimum(before + 1, len(self) - 1)
        part = where - before
        moved = self.translations
        return replace(
            self,
            rotations=rot.slerp(self.rotations[before], self.rotations[after], part[:, None]),
            root_path=_lerp(self.root_path, before, after, part),
            translations=None if moved is None else _lerp(moved, before, after, part),
            missing=None if self.missing is None else self.missing[before] | self.missing[after],
        )

    def select(self, joints: Iterable[str]) -> Motion:
        """Return the motion of some joints; what lies between them is folded in.

        The root always stays. A joint whose parent is left out hangs on its nearest
        ancestor that stays, with the rotations between multiplied into its own; its offset
        is then the mean over time of its position on that ancestor.

        Raises
        ------
        SkeletonMismatch
            If a name is not a joint.
        """
        keep = sorted({0, *self.skeleton.indices(joints).tolist()})
        positions, turns = forward_kinematics(
            self.skeleton, self.rotations, self.root_path, translations=self.translations
        )
        parents = [-1] + [self._kept_ancestor(joint, keep) for joint in keep[1:]]
        above = [keep[parent] for parent in parents[1:]]
        local, offsets = turns[:, keep].copy(), np.zeros((len(self), len(keep), 3))
        inverse = rot.conjugate(turns[:, above])
        local[:, 1:] = rot.multiply(inverse, turns[:, keep[1:]])
        offsets[:, 1:] = rot.rotate(inverse, positions[:, keep[1:]] - positions[:, above])
        direct = all(self.skeleton.parents[j] == a for j, a in zip(keep[1:], above, strict=True))
        mean = self.skeleton.offsets[keep] if direct else offsets.mean(axis=0)
        ends = tuple((keep.index(j), o) for j, o in self.skeleton.end_sites if j in keep)
        names = tuple(self.skeleton.names[joint] for joint in keep)
        return replace(
            self,
            skeleton=Skeleton(names, tuple(parents), mean, ends, free=self.skeleton.free),
            rotations=local,
            translations=None if direct and self.translations is None else offsets,
            missing=None if self.missing is None else self.missing[:, keep],
        )

    def _kept_ancestor(self, joint: int, keep: list[int]) -> int:
        parent = self.skeleton.parents[joint]
        while parent not in keep:
            parent = self.skeleton.parents[parent]
        return keep.index(parent)

    def with_root_motion(self) -> Motion:
        """Move what lies between the root and the body's first branching into the root.

        Some files keep an unmoving root at the origin and move the hips below it; joints that
        lie on the way to the first joint with several children then stand still, and every
        joint keeps its place in the world.
        """
        chain = list(self.skeleton.trunk)
        if len(chain) == 1:
            return self
        places, turns = forward_kinematics(
            self.skeleton, self.rotations, self.root_path, translations=self.translations
        )
        rotations = self.rotations.copy()
        rotations[:, chain] = (1.0, 0.0, 0.0, 0.0)
        rotations[:, 0] = turns[:, chain[-1]]
        offset = self.skeleton.offsets[chain[1:]].sum(axis=0)
        moved = None
        if self.translations is not None:
            moved = self.translations.copy()
            moved[:, chain[1:]] = self.skeleton.offsets[chain[1:]]
        return replace(
            self,
            rotations=rotations,
            root_path=places[:, chain[-1]] - rot.rotate(rotations[:, 0], offset),
            translations=moved,
        )

    def scaled(self, factor: float) -> Motion:
        """Return the motion with every length multiplied by a factor.

        Raises
        ------
        ValueError
            If the factor is not positive and finite.
        """
        if not (np.isfinite(factor) and factor > 0.0):
            raise ValueError(f"expected a positive scale, found {factor}")
        moved = self.translations
        return replace(
            self,
            skeleton=self.skeleton.scaled(factor),
            root_path=self.root_path * factor,
            translations=None if moved is None else moved * factor,
        )

    def turned(self, turn: ArrayLike) -> Motion:
        """Return the motion with the world turned about the origin; the pose at rest stays.

        Parameters
        ----------
        turn : (4,) array_like
            A unit quaternion (w, x, y, z).
        """
        rotations = self.rotations.copy()
        rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
        return replace(self, rotations=rotations, root_path=rot.rotate(turn, self.root_path))

    def mirror(self) -> Motion:
        """Return the motion seen in a mirror: left and right joints change places.

        The world is reflected in a vertical plane through the origin, the skeleton in the
        plane between its sides; every joint goes where its partner's mirror image is. A
        skeleton that is not symmetric comes out reflected.

        Raises
        ------
        SkeletonMismatch
            If a joint of one side has no partner on the other.
        """
        other = partners(self.skeleton)
        across = lateral_axis(self.skeleton, other)
        sideways = across if across != self.up else (0 if self.up else 2)
        moved = self.translations
        return replace(
            self,
            skeleton=reflected_skeleton(self.skeleton, other, across, sideways),
            rotations=reflected_rotations(self.rotations, other, across, sideways),
            root_path=self.root_path * reflection(sideways),
            translations=None if moved is None else moved[:, other] * reflection(across),
            missing=None if self.missing is None else self.missing[:, other],
        )

    def _with_frames(self, frames: slice) -> Motion:
        moved = self.translations
        return replace(
            self,
            rotations=self.rotations[frames],
            root_path=self.root_path[frames],
            translations=None if moved is None else moved[frames],
            missing=None if self.missing is None else self.missing[frames],
        )


def concatenate(motions: Sequence[Motion]) -> Motion:
    """Join motions of one skeleton and frame rate end to end.

    Raises
    ------
    ValueError
        If there are none, or their frame rates differ.
    SkeletonMismatch
        If their skeletons differ.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> len(rl.concatenate([walk, walk])) == 2 * len(walk)
    True
    """
    motions = all_expected(Motion, motions)
    if not motions:
        raise ValueError("expected at least one motion, found none")
    first = motions[0]
    for other in motions[1:]:
        first.skeleton.require_same(other.skeleton)
        if not np.isclose(other.frame_time, first.frame_time, rtol=1e-4):
            raise ValueError(f"expected one frame rate, found {first.fps:g} and {other.fps:g} fps")
    moved = None
    if any(m.translations is not None for m in motions):
        moved = np.concatenate([_translations(m) for m in motions])
    missing = None
    if any(m.missing is not None for m in motions):
        missing = np.concatenate([_missing(m) for m in motions])
    return replace(
        first,
        rotations=np.concatenate([m.rotations for m in motions]),
        root_path=np.concatenate([m.root_path for m in motions]),
        translations=moved,
        missing=missing,
    )


def _missing(motion: Motion) -> NDArray[np.bool_]:
    if motion.missing is not None:
        return motion.missing
    return np.zeros(motion.rotations.shape[:2], bool)


def _translations(motion: Motion) -> Array:
    if motion.translations is not None:
        return motion.translations
    return np.broadcast_to(motion.skeleton.offsets, (*motion.rotations.shape[:2], 3))


def checked_rate(fps: float) -> float:
    """Return a frame rate to sample at.

    Raises
    ------
    ValueError
        If it is not positive, or beyond 10,000.
    """
    if not 0.0 < fps <= FASTEST:
        raise ValueError(f"expected a positive frame rate up to {FASTEST:g}, found {fps:g}")
    return fps


def _lerp(values: Array, before: Array, after: Array, part: Array) -> Array:
    weight = part.reshape(-1, *[1] * (values.ndim - 1))
    return (1.0 - weight) * values[before] + weight * values[after]


def _check_shape(what: str, array: Array, expected: tuple[int, ...]) -> None:
    if array.shape != expected:
        raise ValueError(f"expected {what} of shape {expected}, found {array.shape}")
    if not all(np.all(np.isfinite(array[rows])) for rows in _blocks(len(array))):
        raise ValueError(f"expected finite {what}, found NaN or infinity")


def _blocks(frames: int) -> Iterator[slice]:
    """Yield ranges of frames: what is computed of each takes little memory."""
    for start in range(0, frames, _BLOCK):
        yield slice(start, start + _BLOCK)


def _continuous(rotations: Array) -> Array:
    """Return rotations of continuous signs: the same array if it has them and never changes."""
    if _is_frozen(rotations):
        # Of each block the last frame before it is looked at, too.
        ranges = (slice(max(rows.start - 1, 0), rows.stop) for rows in _blocks(len(rotations)))
        if all(rot.is_continuous(rotations[rows]) for rows in ranges):
            return rotations
    return rot.continuous(rotations)


def _own(array: Array) -> Array:
    """Return an array that nobody else can change."""
    return array if _is_frozen(array) else array.copy()


def _is_frozen(array: Array) -> bool:
    """Tell whether neither an array nor what it is a view of can be written to."""
    seen: object = array
    while isinstance(seen, np.ndarray):
        if seen.flags.writeable:
            return False
        seen = seen.base
    return seen is None


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    array.flags.writeable = False
    return array
