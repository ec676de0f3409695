# SPDX-License-Identifier: GPL-3.0-or-later
"""Every loop is played back and compared with what was meant: what differs is not kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay import Motion
from roundelay.geometry import rotations as rot
from roundelay.loops.join import join_ratio

from .averaging import Windows
from .body import Body
from .ground import Ground

Array = NDArray[np.float64]

# Body sizes by which a loop may be elsewhere than meant: 1.7 cm of a person of 1.7 m.
LIMIT = 0.009
# Joins above are moved by up to so many frames.
_HARD, _CALMER = 1.05, 4
# Parts of a period in which the capture's repetitions are compared with the loop.
_PARTS = 12


@dataclass(frozen=True)
class Played:
    """How a loop plays.

    Attributes
    ----------
    away : float
        The most that a joint is elsewhere than meant, in body sizes.
    joint : str
        Which.
    join : float
        Acceleration where it is joined over the largest elsewhere.
    calmer : int
        By how many frames later it would be joined more softly, where it is joined hard.
    calm : float
        The join there.
    """

    away: float
    joint: str
    join: float
    calmer: int = 0
    calm: float = 0.0

    @property
    def kept(self) -> bool:
        """Whether it plays as was meant."""
        return self.away <= LIMIT

    @property
    def told(self) -> str:
        """In one line."""
        return f"{self.joint} is {self.away:.1%} of the body's size elsewhere than in the capture"


def against_motion(
    places: Array, meant: Array, names: Sequence[str], size: float, rows: Sequence[int]
) -> Played:
    """Compare a loop's joints as played (N + 1, J, 3), in some rows, with where they should be."""
    away = np.linalg.norm(places[rows] - meant[rows], axis=-1).max(axis=0) / size
    return _told(away, names, places)


def against_capture(places: Array, body: Body, capture: Motion, ground: Ground) -> Played:
    """Compare a loop's joints as played with the mean of the capture's repetitions.

    Parameters
    ----------
    places : (N + 1, J, 3) ndarray
        In the body's axes.
    body : Body
    capture : Motion
        The body's, in the armature.
    ground : Ground
    """
    windows = ground.windows
    seen, turns = _seen(windows, ground.frames)
    shown = capture.positions()[seen][:, : len(body.names)]
    own = _own(shown, ground.path[seen], ground, ground.frames[seen])
    where = ((turns - windows.turns[0]) % 1.0) * windows.count
    loop = places - (places[:, :1] * ground.along)
    meant = _between(loop, where)
    part = np.minimum((where * _PARTS / windows.count).astype(int), _PARTS - 1)
    apart = [np.linalg.norm((own - meant)[part == p].mean(axis=0), axis=-1) for p in set(part)]
    away = np.max(apart, axis=0)
    root = np.linalg.norm((places[:, 0] - ground.loop) * ground.along, axis=-1)
    away[0] = max(away[0], np.abs(root - root.mean()).max())
    closes = np.linalg.norm(places[-1] - places[0] - (ground.loop[-1] - ground.loop[0]), axis=-1)
    return _told(np.maximum(away, closes) / ground.size, body.names, places)


def _seen(windows: Windows, frames: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the rows of frames in windows, and their phases."""
    rows, turns = [], []
    for window in range(len(windows)):
        begin, end = windows.ends[window]
        inside = np.flatnonzero((frames >= begin) & (frames < end))
        order = np.argsort(windows.frames[window])
        at, phase = windows.frames[window][order], windows.phase[window][order]
        rows.append(inside)
        turns.append(_extended(frames[inside], at, phase, windows.count))
    return np.concatenate(rows), np.concatenate(turns)


def _extended(frames: Array, at: Array, phase: Array, count: int) -> Array:
    """Return the phases of frames, evenly beyond those that are known."""
    pace = 1.0 / count
    found = np.interp(frames, at, phase)
    return found + (np.minimum(frames - at[0], 0.0) + np.maximum(frames - at[-1], 0.0)) * pace


def _own(places: Array, root: Array, ground: Ground, frames: Array) -> Array:
    """Return places (V, J, 3) as seen from the root (V, 3), straight on."""
    return rot.rotate(ground.back(frames)[:, None], places - (root * ground.along)[:, None])


def _between(rows: Array, where: Array) -> Array:
    """Return rows (N + 1, ...) at fractional places."""
    before = np.minimum(where.astype(int), len(rows) - 2)
    part = (where - before).reshape(-1, *[1] * (rows.ndim - 1))
    return np.asarray((1.0 - part) * rows[before] + part * rows[before + 1])


def _told(away: Array, names: Sequence[str], places: Array) -> Played:
    worst = int(np.argmax(away))
    joins = [join_of(places)]
    while joins[-1] > _HARD and len(joins) <= _CALMER:
        joins.append(join_of(places, len(joins)))
    best = int(np.argmin(joins))
    return Played(float(away[worst]), names[worst], joins[0], best, joins[best])


def join_of(places: Array, later: int = 0) -> float:
    """Return the join of a loop as played (N + 1, J, 3), or if it began some frames later.

    Its steady way is taken out.
    """
    count = len(places) - 1
    steady = (places[-1, :1] - places[0, :1]) * (np.arange(count) / count)[:, None, None]
    return join_ratio(np.roll(places[:-1] - steady, -later, axis=0), count)
