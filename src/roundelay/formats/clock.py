"""The even times at which a motion has frames, found from the keys of its curves."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError, RoundelayWarning

__all__ = ["NEAR", "Clock", "common_clock"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]

NEAR = 0.02
"""Steps by which a key may miss its frame."""
# Frames a second: where keys tell none; what curves are sampled at, at least and at most.
_USUAL, _SLOWEST, _FASTEST = 30.0, 24.0, 120.0
# By which, relatively, a rate may miss a whole number.
_WHOLE = 1e-6
# Times are numbers of 32 bits.
_ROUNDING = 4 * float(np.finfo(np.float32).eps)
# Gaps of more steps between keys do not tell the step well.
_SHORT = 16
# Parts into which the shortest gap is cut to find a step.
_MOST_PARTS = 120
# More frames than hours of capture have.
_MOST_FRAMES = 1 << 22


@dataclass(frozen=True)
class Clock:
    """Even times: those of the keys where they have some, and the seconds between them.

    Parameters
    ----------
    times : (F,) ndarray
        Seconds.
    step : float
        Seconds from one frame to the next.
    """

    times: Array
    step: float

    def between(self, keys: Array) -> tuple[Places, Places, Array, Array]:
        """Return between which of some keys each time lies, and how far.

        Parameters
        ----------
        keys : (n,) ndarray
            Seconds, rising; a key that a time misses by a little is met.

        Returns
        -------
        before, after : (F,) ndarray of int
            Alike beyond the ends.
        gap : (F,) ndarray
            Seconds from one to the other; 1 beyond the ends.
        part : (F,) ndarray
            From 0 to 1.
        """
        last = len(keys) - 1
        late = self.times + NEAR * self.step
        before = np.clip(np.searchsorted(keys, late, "right") - 1, 0, last)
        after = np.minimum(before + 1, last)
        gap = np.where(after > before, keys[after] - keys[before], 1.0)
        return before, after, gap, np.clip((self.times - keys[before]) / gap, 0.0, 1.0)


def common_clock(
    times: Sequence[Array], path: Path, *, straight: bool, rate: float | None = None
) -> Clock:
    """Find times that go through all keys of all tracks.

    Where every track has all keys, and values between them lie on straight lines, these are the
    keys. Where keys lie on an even grid, it is that, made finer where curves would be lost. Else
    there are as many frames a second as the file tells, or 30, and a warning.

    Parameters
    ----------
    times : sequence of (n,) ndarray
        Seconds of each track's keys, rising.
    path : Path
        The file, for errors.
    straight : bool
        Whether values between keys lie on straight lines.
    rate : float, optional
        Frames a second that the file tells.

    Raises
    ------
    FormatError
        If there would be millions of frames.
    """
    keys = _together(times)
    if len(keys) == 1:
        return Clock(keys, 1.0 / (rate or _USUAL))
    plain = straight and all(len(one) == len(keys) for one in times)
    grid = _told_grid(keys, rate) or _fitted(keys, float(np.diff(keys).min()))
    full = grid is not None and len(grid.frames) == grid.frames[-1] + 1
    if not (_told_grid(keys, rate) or (plain and full)):
        grid = _fine_grid(keys)
    if grid is None:
        return _usual_clock(keys, path, rate or _USUAL)
    return _gridded(keys, grid, path)


def _gridded(keys: Array, grid: _Grid, path: Path) -> Clock:
    _check_count(int(grid.frames[-1]), path)
    times = keys[0] + grid.step * np.arange(grid.frames[-1] + 1)
    times[grid.frames] = keys
    rate = 1.0 / grid.step
    whole = abs(rate - round(rate)) <= _WHOLE * rate
    return Clock(times, 1.0 / round(rate) if whole else grid.step)


def _told_grid(keys: Array, rate: float | None) -> _Grid | None:
    """Return the grid of the rate that a file tells, if its keys lie on that."""
    if rate is None or (keys[-1] - keys[0]) * rate >= _MOST_FRAMES:
        return None
    frames = np.rint((keys - keys[0]) * rate).astype(np.int64)
    near = np.abs(keys - keys[0] - frames / rate) <= NEAR / rate
    return _Grid(frames, 1.0 / rate) if near.all() and np.all(np.diff(frames)) else None


@dataclass(frozen=True)
class _Grid:
    """The frame of each key, and the seconds between frames."""

    frames: NDArray[np.int64]
    step: float


def _together(times: Sequence[Array]) -> Array:
    """Return all times, rising, those that only rounding parts as one."""
    keys = np.unique(np.concatenate(times))
    apart = np.diff(keys) > _ROUNDING * np.abs(keys).max()
    return keys[np.concatenate([[True], apart])]


def _fine_grid(keys: Array) -> _Grid | None:
    """Return the coarsest grid through all keys that is fine enough for curves, if there is one."""
    least = float(np.diff(keys).min())
    for parts in range(1, _MOST_PARTS + 1):
        if parts > (1.0 + NEAR) * _FASTEST * least:
            return None
        grid = _fitted(keys, least / parts)
        if grid is not None:
            finer = max(1, ceil(_SLOWEST * grid.step - NEAR))
            return _Grid(grid.frames * finer, grid.step / finer)
    return None


def _fitted(keys: Array, step: float) -> _Grid | None:
    """Return a grid of about this step whose frames the keys lie on, if they do."""
    gaps = np.diff(keys)
    short = gaps <= max(_SHORT * step, 2.0 * float(gaps.min()))
    step = float(gaps[short].sum() / np.round(gaps[short] / step).sum())
    numbers = np.round(gaps / step)
    step = float((keys[-1] - keys[0]) / numbers.sum())
    if step * _MOST_FRAMES < keys[-1] - keys[0] or numbers.min() < 1.0:
        return None
    frames = np.concatenate([[0], np.cumsum(numbers)]).astype(np.int64)
    near = np.abs(keys - keys[0] - step * frames) <= NEAR * step
    return _Grid(frames, step) if near.all() else None


def _usual_clock(keys: Array, path: Path, rate: float) -> Clock:
    """Return a usual rate, and say so."""
    text = f"keys at uneven times are sampled at {rate:g} frames a second"
    warnings.warn(f"{path}: {text}", RoundelayWarning, stacklevel=2)
    last = float(np.floor((keys[-1] - keys[0]) * rate + NEAR))
    _check_count(last, path)
    return Clock(keys[0] + np.arange(int(last) + 1) / rate, 1.0 / rate)


def _check_count(frames: float, path: Path) -> None:
    if frames >= _MOST_FRAMES:
        told = f"expected fewer than {_MOST_FRAMES} frames, found {frames:.0f}"
        raise FormatError(told, path=path)
