"""The frame of a body of points: where its trunk is and how it is turned, frame by frame.

The frame of each moment is the rotation and place that carry the trunk's shape onto what is seen
(least squares, Kabsch 1976); the shape is the mean over all frames (generalised Procrustes
analysis). No axis is singular, and points that are missing carry no weight. A trunk that is a line,
such as two hips, tells no turn about itself: it stays upright.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import TooShort
from roundelay.geometry import rotations as rot
from roundelay.geometry.thresholds import UPRIGHT
from roundelay.motion.poses import Mask
from roundelay.motion.thresholds import FRAME

__all__ = ["Frame", "standing", "trunk_frame"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]


@dataclass(frozen=True)
class Frame:
    """Where a trunk is.

    Attributes
    ----------
    places : (F, 3) ndarray
        Of its middle.
    turns : (F, 4) ndarray
        Rotations from the trunk's shape to what is seen.
    trunk : (k,) ndarray of int
        The points that carry it.
    shape : (k, 3) ndarray
        The trunk itself, its middle at the origin.
    """

    places: Array
    turns: Array
    trunk: Places
    shape: Array

    def inside(self, positions: Array) -> Array:
        """Return positions (F, J, 3) of the world as they are in the frame."""
        return rot.rotate(rot.conjugate(self.turns)[:, None], positions - self.places[:, None])

    def outside(self, inside: Array) -> Array:
        """Return positions (F, J, 3) in the frame as they are in the world."""
        return rot.rotate(self.turns[:, None], inside) + self.places[:, None]

    def aligned(self, turn: Array) -> Frame:
        """Return the frame with its axes turned (4,): the same places in the world."""
        back = rot.multiply(self.turns, rot.conjugate(turn))
        return Frame(self.places, back, self.trunk, rot.rotate(turn, self.shape))


def trunk_frame(positions: Array, seen: Mask, trunk: Places, *, planar: bool) -> Frame:
    """Follow a trunk.

    Parameters
    ----------
    positions : (F, J, 3) ndarray
    seen : (F, J) ndarray of bool
    trunk : (k,) ndarray of int
        Its points, at least one.
    planar : bool
        Whether points lie in the plane of X and Y and turn in it alone.

    Returns
    -------
    Frame
        Between frames in which too little of the trunk is seen, it goes on evenly.

    Raises
    ------
    TooShort
        If there is no frame in which enough is seen.
    """
    x, mask = positions[:, trunk], seen[:, trunk]
    if not planar and _is_line(x, mask):
        x, mask = _upright(positions, seen, x, mask)
    needed, most = min(2 if planar else 3, mask.shape[1]), int(mask.sum(axis=1).max(initial=0))
    if most < needed:
        asked = f"frames in which {needed} points of the trunk are seen"
        raise TooShort(f"expected {asked}; of {len(trunk)} at most {most} are seen at once")
    shape = _shape(x, mask, needed, planar)
    mask = _keeping(x, mask, shape, needed, planar)
    turns, places = _carried(x, mask, shape, planar)
    known = np.flatnonzero(mask.sum(axis=1) >= needed)
    turns, places = _bridged(turns, places, known, len(x))
    return Frame(places, turns, trunk, shape[: len(trunk)])


def _is_line(x: Array, mask: Mask) -> bool:
    """Tell whether several points (F, k, 3) lie on one line."""
    whole = x[mask.all(axis=1)]
    if mask.shape[1] < 2 or not len(whole):
        return False
    long, wide = np.linalg.svd(whole - whole.mean(axis=1, keepdims=True), compute_uv=False).T[:2]
    return bool(np.median(wide) < FRAME.line * np.median(long))


def _upright(positions: Array, seen: Mask, x: Array, mask: Mask) -> tuple[Array, Mask]:
    """Put a point above the middle of a line of points, as high as they lie apart."""
    few = np.unique(np.linspace(0, len(x) - 1, FRAME.frames).round().astype(int))
    up = standing(np.where(seen[few, :, None], positions[few], np.nan))
    whole: Mask = np.asarray(mask.all(axis=1))
    above = x.mean(axis=1, keepdims=True)
    above[..., up] += np.median(np.ptp(x[whole], axis=1).max(axis=1))
    return np.concatenate([x, above], axis=1), np.concatenate([mask, whole[:, None]], axis=1)


def standing(positions: Array) -> int:
    """Return the axis, Y or Z, along which points (F, J, 3), NaN where not seen, stand.

    Along it a body is high above its lowest point, which keeps its height.
    """
    with warnings.catch_warnings():
        # A frame in which nothing is seen has no lowest point.
        warnings.simplefilter("ignore", RuntimeWarning)
        lowest = np.nanquantile(positions, FRAME.lowest, axis=1)
        height = np.nanmedian(np.nanmean(positions, axis=1) - lowest, axis=0)
        varies = np.nanstd(lowest, axis=0) + UPRIGHT.floor * height.max()
    # Compared without a division: points that all lie at one place have no height.
    return 2 if height[2] * varies[1] > height[1] * varies[2] else 1


def _keeping(x: Array, mask: Mask, shape: Array, needed: int, planar: bool) -> Mask:
    """Return what is seen (F, k) of a trunk without what lies far off its place in the shape.

    Where too little would be left, all stays.
    """
    for _ in range(FRAME.rounds):
        turns, places = _carried(x, mask, shape, planar)
        off = np.linalg.norm(x - places[:, None] - rot.rotate(turns[:, None], shape), axis=2)
        usual = np.array([np.median(one[own]) for one, own in zip(off.T, mask.T, strict=True)])
        far = mask & (off > FRAME.off * usual)
        # One a frame, the farthest: it may have pulled the others off.
        worst = far & (off == np.where(mask, off, 0.0).max(axis=1, keepdims=True))
        worst[mask.sum(axis=1) <= needed] = False
        if not worst.any():
            break
        mask = mask & ~worst
    return mask


def _shape(x: Array, mask: Mask, needed: int, planar: bool) -> Array:
    """Return the shape (k, 3) that points keep on average, its middle at the origin.

    It begins with the frame that shows most, and takes in points as they are seen.
    """
    order = np.argsort(-mask.sum(axis=1), kind="stable")
    few = np.sort(order[: max(1, len(x) // 2)])
    few = few[np.unique(np.linspace(0, len(few) - 1, FRAME.frames).round().astype(int))]
    first = int(order[0])
    shape, known = x[first] - x[first, mask[first]].mean(axis=0), mask[first].copy()
    x, mask = x[few], mask[few]
    for _ in range(FRAME.rounds):
        usable = mask & known
        turns, places = _carried(x, usable, shape, planar)
        back = rot.rotate(rot.conjugate(turns)[:, None], x - places[:, None])
        there = mask & (usable.sum(axis=1) >= needed)[:, None]
        count = there.sum(axis=0)[:, None]
        mean = np.sum(np.where(there[..., None], back, 0.0), axis=0) / np.maximum(count, 1)
        shape = np.where(count, mean, shape)
        known |= count[:, 0] > 0
    return np.asarray(shape - shape[known].mean(axis=0))


def _carried(x: Array, mask: Mask, shape: Array, planar: bool) -> tuple[Array, Array]:
    """Return rotations (F, 4) and places (F, 3) of the origin that carry a shape onto points."""
    share = mask / np.maximum(mask.sum(axis=1, keepdims=True), 1)
    middle = np.einsum("fn,fnd->fd", share, x)
    own = share @ shape
    a = x - middle[:, None]
    b = shape[None] - own[:, None]
    product = np.einsum("fn,fnd,fne->fde", share, a, b)
    turns = _planar(product) if planar else rot.from_matrix(_nearest_rotation(product))
    return turns, middle - rot.rotate(turns, own)


def _nearest_rotation(product: Array) -> Array:
    """Return the rotations (F, 3, 3) nearest to some matrices (Kabsch)."""
    u, _, vt = np.linalg.svd(product)
    flip = np.sign(np.linalg.det(u @ vt))
    u[..., 2] *= np.where(flip == 0.0, 1.0, flip)[:, None]
    return np.asarray(u @ vt)


def _planar(product: Array) -> Array:
    """Return the rotations (F, 4) about Z that carry a shape best."""
    angle = np.arctan2(product[:, 1, 0] - product[:, 0, 1], product[:, 0, 0] + product[:, 1, 1])
    return rot.from_rotation_vector(angle[:, None] * np.array([0.0, 0.0, 1.0]))


def _bridged(turns: Array, places: Array, known: Places, count: int) -> tuple[Array, Array]:
    """Return rotations and places of all frames from those that are known."""
    frames = np.arange(count)
    after = np.minimum(np.searchsorted(known, frames), len(known) - 1)
    before = np.maximum(np.searchsorted(known, frames, side="right") - 1, 0)
    left, right = known[before], known[after]
    width = np.maximum(right - left, 1)
    part = np.clip((frames - left) / width, 0.0, 1.0)
    own = rot.continuous(turns[known])
    turned = rot.slerp(own[before], own[after], part[:, None][:, 0])
    moved = np.stack([np.interp(frames, known, places[known, axis]) for axis in range(3)], axis=1)
    return rot.continuous(turned), moved
