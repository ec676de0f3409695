"""Put a body on the ground: its hips at their height, its feet still where they stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SIX_DIGITS
from roundelay.base.spans import Spans
from roundelay.cycles.edit.footlock import eased
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import contacts
from roundelay.retargeting.anatomy import Anatomy
from roundelay.retargeting.carrying import Pose, Seen
from roundelay.retargeting.moving import move_end
from roundelay.retargeting.reference import Reference, Stand
from roundelay.retargeting.thresholds import STANDING

__all__ = ["Ground", "ground_of", "put_on_ground"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Ground:
    """Where a motion touches the ground.

    Attributes
    ----------
    balls : (F, n, 3) ndarray
        Of the feet.
    standing : (F, n) ndarray of bool
        When they do.
    soles : (F, n) ndarray
        How high the lowest of their soles are.
    level : float
        How high the ground is.
    """

    balls: Array
    standing: NDArray[np.bool_]
    soles: Array
    level: float


def _balls(anatomy: Anatomy, reference: Reference, places: Array, turns: Array) -> Array:
    """Return where the balls of the feet are (F, n, 3)."""
    found = [
        places[:, stand.joint] + rot.rotate(turns[:, stand.joint], stand.offset)
        for stand in reference.stands
    ]
    return np.stack(found, axis=1)


def ground_of(source: Seen, anatomy: Anatomy, reference: Reference, fps: float, up: int) -> Ground:
    """Find the ground that a motion stands on, and when its feet do.

    Parameters
    ----------
    source : Seen
    anatomy : Anatomy
    reference : Reference
    fps : float
    up : int
        The vertical axis of what is seen.
    """
    balls = _balls(anatomy, reference, source.places, source.turns)
    standing = contacts(balls, fps=fps, size=anatomy.skeleton.size, up=up)
    heights = balls[:, :, up] - np.array([stand.ball for stand in reference.stands])
    shown = heights[standing] if standing.any() else heights
    level = np.median(shown) if standing.any() else np.quantile(shown, STANDING.ground)
    soles = _soles(anatomy, reference, source.places, source.turns, up)
    return Ground(balls, standing, soles, float(level))


def put_on_ground(
    pose: Pose, source: Seen, from_body: Anatomy, stands: tuple[Stand, ...], ground: Ground,
    fps: float, up: int,
) -> Array:  # fmt: skip
    """Move a body to where it goes, and its feet to where they stand.

    The root's way is that of the source, longer or shorter as its legs are.

    Parameters
    ----------
    pose : Pose
        Its legs are turned.
    source : Seen
    from_body : Anatomy
        Of the source.
    stands : tuple of Stand
        Of the source.
    ground : Ground
        Of the source.
    fps : float
    up : int
        The vertical axis.

    Returns
    -------
    (F, 3) ndarray
        The path of the root.
    """
    anatomy, own = pose.anatomy, pose.reference.stands
    scale = anatomy.leg_length / from_body.leg_length
    # What was below the ground may be so again, but no deeper.
    lowest = scale * np.minimum(ground.level, ground.soles)
    hips = scale * source.places[:, list(from_body.hips)].mean(axis=1)
    hips[:, up] += _mean([s.ankle for s in own]) - scale * _mean([s.ankle for s in stands])
    wanted = scale * ground.balls
    wanted[:, :, up] += [
        one.ball - scale * other.ball for one, other in zip(own, stands, strict=True)
    ]
    path = _root_path(pose, hips)
    path = path + _usual_lack(pose, path, wanted, ground, up) * np.eye(3)[up]
    offsets = _held(pose, path, wanted, ground, up)
    drop = _lowered(pose, path, offsets, fps, up)
    path = path - drop[:, None] * np.eye(3)[up]
    for _ in range(STANDING.rounds):
        places, turns = pose.solved(path)[1:]
        soles = _soles(pose.anatomy, pose.reference, places, turns, up)
        asked = _held(pose, path, wanted, ground, up)
        asked[:, :, up] = np.maximum(asked[:, :, up], np.maximum(lowest - soles, 0.0))
        for number, limb in enumerate(anatomy.legs):
            move_end(pose, limb, places, turns, asked[:, number])
    return path


def _mean(values: list[float]) -> float:
    return float(np.mean(values))


def _root_path(pose: Pose, hips: Array) -> Array:
    """Return the path (F, 3) of the root that brings the middle of the hips to places."""
    _, places, _ = pose.solved()
    return hips - places[:, list(pose.anatomy.hips)].mean(axis=1)


def _usual_lack(pose: Pose, path: Array, wanted: Array, ground: Ground, up: int) -> float:
    """Return by how much standing feet are usually too low: the hips go up, no knee is bent."""
    _, places, turns = pose.solved(path)
    lack = (wanted - _balls(pose.anatomy, pose.reference, places, turns))[:, :, up]
    feet = zip(lack.T, ground.standing.T, strict=True)
    usual = [np.median(own[stands]) for own, stands in feet if stands.any()]
    # Feet alike: one may be longer, or tread on another floor.
    return float(np.mean(usual)) if usual else 0.0


def _held(pose: Pose, path: Array, wanted: Array, ground: Ground, up: int) -> Array:
    """Return by how much (F, n, 3) to move each foot so that it stands as the source's does.

    While it stands, it moves as the source's does, about where it is on average; in between, the
    offset of one stand goes over into that of the next.
    """
    _, places, turns = pose.solved(path)
    balls = _balls(pose.anatomy, pose.reference, places, turns)
    offsets = wanted - balls
    for foot in range(offsets.shape[1]):
        held = Spans.of_mask(ground.standing[:, foot])
        for start, stop in held:
            level = offsets[start:stop, foot].mean(axis=0)
            level[up] = 0.0
            offsets[start:stop, foot] -= level
        offsets[:, foot] = eased(offsets[:, foot], list(held)) if held else 0.0
    return offsets


def _lowered(pose: Pose, path: Array, offsets: Array, fps: float, up: int) -> Array:
    """Return by how much (F,) to lower the hips so that standing legs reach the ground."""
    _, places, _ = pose.solved(path)
    drop = np.zeros(len(path))
    for number, limb in enumerate(pose.anatomy.legs):
        end = limb.end if limb.end is not None else limb.lower[-1]
        way = places[:, end] + offsets[:, number] - places[:, limb.upper[0]]
        now = np.linalg.norm(places[:, end] - places[:, limb.upper[0]], axis=1)
        # What is straighter already may stay so.
        most = np.maximum(STANDING.reach * pose.anatomy.length(limb), now)
        level = np.sum(np.delete(way, up, axis=1) ** 2, axis=1)
        deepest = np.sqrt(np.maximum(most**2 - level, 0.0))
        over = np.linalg.norm(way, axis=1) > most * (1.0 + SIX_DIGITS)
        drop = np.maximum(drop, np.where(over, np.maximum(-way[:, up] - deepest, 0.0), 0.0))
    return _smoothed(drop, max(1, round(STANDING.ease * fps)))


def _smoothed(values: Array, reach: int) -> Array:
    """Return values (F,) that are smooth and no smaller than those given, but for short ones."""
    if not values.any():
        return values
    padded = np.pad(values, 2 * reach, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1)
    largest = windows.max(axis=1)
    kernel = np.hanning(2 * reach + 3)[1:-1]
    return np.convolve(largest, kernel / kernel.sum(), mode="valid")


def _soles(anatomy: Anatomy, reference: Reference, places: Array, turns: Array, up: int) -> Array:
    """Return how high (F, n) the lowest of each foot's sole is, below its ball and its ankle."""
    lowest = []
    for limb, stand in zip(anatomy.legs, reference.stands, strict=True):
        end = limb.end if limb.end is not None else limb.lower[-1]
        ball = places[:, stand.joint] + rot.rotate(turns[:, stand.joint], stand.offset)
        upward = rot.rotate(reference.frames[end], np.array([0.0, 1.0, 0.0]))
        heel = places[:, end] - stand.ankle * rot.rotate(turns[:, end], upward)
        lowest.append(np.minimum(ball[:, up] - stand.ball, heel[:, up]))
    return np.stack(lowest, axis=1)
