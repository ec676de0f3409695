"""The keys of a glTF animation: what they hold, and the even times at which a motion has frames."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import RoundelayWarning
from roundelay.formats.gltf_document import Document, Part
from roundelay.geometry import rotations as rot

__all__ = ["Clock", "Track", "common_clock", "read_track"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]

_KINDS = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}
# Frames a second: where keys tell none; what curves are sampled at, at least and at most.
_USUAL, _SLOWEST, _FASTEST = 30.0, 24.0, 120.0
# Steps by which a key may miss its frame, and by which a rate may miss a whole number.
_NEAR, _WHOLE = 0.02, 1e-6
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


@dataclass(frozen=True)
class Track:
    """What one channel does to its node.

    Parameters
    ----------
    part : Part
        The sampler.
    kind : {"translation", "rotation", "scale"}
    mode : {"LINEAR", "STEP", "CUBICSPLINE"}
    times : (n,) ndarray
        Of the keys, rising.
    values : (n, k, d) ndarray
        The value at a key, between its tangents where there are some; rotations as (w, x, y, z).
    """

    part: Part
    kind: str
    mode: str
    times: Array
    values: Array

    @property
    def shown(self) -> Array:
        """The values (n, d) at the keys."""
        return self.values[:, self.values.shape[1] // 2]

    def at(self, clock: Clock) -> Array:
        """Return the values (F, d) at the times of a clock.

        Raises
        ------
        FormatError
            If a rotation vanishes between two keys.
        """
        keys, last = self.times, len(self.times) - 1
        late = clock.times + _NEAR * clock.step
        before = np.clip(np.searchsorted(keys, late, "right") - 1, 0, last)
        after = np.minimum(before + 1, last)
        gap = np.where(after > before, keys[after] - keys[before], 1.0)
        part = np.clip((clock.times - keys[before]) / gap, 0.0, 1.0)
        if self.mode == "STEP":
            return self.shown[before]
        if self.mode == "CUBICSPLINE":
            return self._curved(before, after, part[:, None], gap[:, None])
        first, second = self.shown[before], self.shown[after]
        if self.kind == "rotation":
            return rot.slerp(first, second, part)
        return first + part[:, None] * (second - first)

    def _curved(self, before: Places, after: Places, t: Array, gap: Array) -> Array:
        """Return Hermite splines (glTF 2.0, appendix C.4)."""
        leaving, arriving = gap * self.values[before, 2], gap * self.values[after, 0]
        first, second = self.shown[before], self.shown[after]
        result = (
            (2 * t**3 - 3 * t**2 + 1) * first
            + (t**3 - 2 * t**2 + t) * leaving
            + (3 * t**2 - 2 * t**3) * second
            + (t**3 - t**2) * arriving
        )
        return _units(result, self.part) if self.kind == "rotation" else result


def read_track(document: Document, sampler: Part, kind: str) -> Track:
    """Read a sampler of a channel.

    Raises
    ------
    FormatError
        If its keys do not rise, or it has not a value a key.
    """
    mode = sampler.get("interpolation", "LINEAR")
    if mode.value not in ("LINEAR", "STEP", "CUBICSPLINE"):
        raise mode.error("'LINEAR', 'STEP' or 'CUBICSPLINE'")
    times = document.accessor(sampler.get("input"), "SCALAR")[:, 0]
    if np.any(np.diff(times) <= 0.0):
        raise sampler.get("input").error("times that rise", "others")
    values = document.accessor(sampler.get("output"), _KINDS[kind])
    rows = 3 if mode.value == "CUBICSPLINE" else 1
    if len(values) != rows * len(times):
        raise sampler.error(f"{rows * len(times)} values for {len(times)} keys", str(len(values)))
    if kind == "rotation":
        values = np.roll(values, 1, axis=1)
    values = values.reshape(len(times), rows, -1)
    if kind == "rotation":
        values[:, rows // 2] = _units(values[:, rows // 2], sampler)
    return Track(sampler, kind, mode.value, times, values)


def _units(values: Array, sampler: Part) -> Array:
    if np.any(np.linalg.norm(values, axis=1) == 0.0):
        raise sampler.error("quaternions of length 1", "one of length 0")
    return rot.normalize(values)


def common_clock(tracks: Sequence[Track], animation: Part) -> Clock:
    """Find times that go through all keys of all tracks.

    Where every track has all keys, and values between them lie on straight lines, these are the
    keys. Where keys lie on an even grid, it is that, made finer where curves would be lost. Else
    there are 30 frames a second, and a warning.

    Raises
    ------
    FormatError
        If there would be millions of frames.
    """
    keys = _together([track.times for track in tracks])
    if len(keys) == 1:
        return Clock(keys, 1.0 / _USUAL)
    plain = all(one.mode == "LINEAR" and len(one.times) == len(keys) for one in tracks)
    grid = _fitted(keys, float(np.diff(keys).min()))
    if not (plain and grid is not None and len(grid.frames) == grid.frames[-1] + 1):
        grid = _fine_grid(keys)
    if grid is None:
        return _usual_clock(keys, animation)
    _check_count(int(grid.frames[-1]), animation)
    times = keys[0] + grid.step * np.arange(grid.frames[-1] + 1)
    times[grid.frames] = keys
    rate = 1.0 / grid.step
    whole = abs(rate - round(rate)) <= _WHOLE * rate
    return Clock(times, 1.0 / round(rate) if whole else grid.step)


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
        if parts > (1.0 + _NEAR) * _FASTEST * least:
            return None
        grid = _fitted(keys, least / parts)
        if grid is not None:
            finer = max(1, ceil(_SLOWEST * grid.step - _NEAR))
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
    near = np.abs(keys - keys[0] - step * frames) <= _NEAR * step
    return _Grid(frames, step) if near.all() else None


def _usual_clock(keys: Array, animation: Part) -> Clock:
    """Return 30 frames a second, and say so."""
    text = f"keys at uneven times are sampled at {_USUAL:g} frames a second"
    warnings.warn(f"{animation.path}: {text}", RoundelayWarning, stacklevel=2)
    last = float(np.floor((keys[-1] - keys[0]) * _USUAL + _NEAR))
    _check_count(last, animation)
    return Clock(keys[0] + np.arange(int(last) + 1) / _USUAL, 1.0 / _USUAL)


def _check_count(frames: float, animation: Part) -> None:
    if frames >= _MOST_FRAMES:
        raise animation.error(f"fewer than {_MOST_FRAMES} frames", f"{frames:.0f}")
