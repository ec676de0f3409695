"""The keys of a glTF animation: what they hold, and what they show between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.clock import Clock
from roundelay.formats.gltf_document import Document, Part
from roundelay.geometry import rotations as rot

__all__ = ["Track", "read_track"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]

_KINDS = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}


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
        before, after, gap, part = clock.between(self.times)
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
