"""Packing of the page's data: numbers to 16 or 24 bits, everything deflated into one text."""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.numeric import SMALLEST

__all__ = ["Packer"]

Array = NDArray[np.float64]

_LEVELS = 65535
# Levels that fit in 24 bits, with the one that rounding may add.
_FINEST = 2.0**24 - 2.0


class Packer:
    """Collect arrays; then write them, with the document that refers to them, as one text.

    An array becomes 16-bit steps within the range of each column, and the differences from one
    row to the next, which deflate well. Its place in the document is a reference::

        {"at": byte offset, "rows": n, "planes": bytes a number,
         "low": [one a column], "step": [one a column]}
    """

    def __init__(self) -> None:
        self._chunks: list[bytes] = []
        self._length = 0

    def add(self, values: ArrayLike, *, common_step: bool = False) -> dict[str, Any]:
        """Add values (n,) or (n, d) and return the reference.

        Parameters
        ----------
        values : array_like
            Finite numbers.
        common_step : bool
            Use one step for all columns, as positions in space want, with its floor for each.
        """
        table = np.asarray(values, float)
        table = table.reshape(len(table), -1)
        low = table.min(axis=0)
        width = table.max(axis=0) - low
        step = (np.full_like(width, width.max(initial=0.0)) if common_step else width) / _LEVELS
        step = np.where(step > 0.0, step, 1.0)
        return self._referenced(np.round((table - low) / step), low, step, planes=2)

    def add_decimals(self, values: ArrayLike, decimals: int) -> dict[str, Any]:
        """Add values (n, d) rounded to so many decimals, in 24 bits, and return the reference.

        A column whose range is too wide for that has fewer decimals.
        """
        table = np.asarray(values, float)
        width = np.maximum(np.ptp(table, axis=0), SMALLEST)
        fitting = np.floor(np.log10(_FINEST / width))
        power = 10.0 ** np.minimum(decimals, fitting)
        levels = np.round(table * power)
        low, step = levels.min(axis=0), 1.0 / power
        return self._referenced(levels - low, low * step, step, planes=3)

    def _referenced(self, levels: Array, low: Array, step: Array, *, planes: int) -> dict[str, Any]:
        place = self._append(_coded(levels, planes))
        reference: dict[str, Any] = {"at": place, "rows": len(levels), "planes": planes}
        for name, column in {"low": low, "step": step}.items():
            reference[name] = [float(f"{value:.8g}") for value in column]
        return reference

    def _append(self, chunk: bytes) -> int:
        place = self._length
        self._chunks.append(chunk)
        self._length += len(chunk)
        return place

    def text(self, document: dict[str, Any]) -> str:
        """Return document and arrays, deflated, in base 64."""
        head = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
        whole = b"".join([len(head).to_bytes(4, "little"), head, *self._chunks])
        return base64.b64encode(zlib.compress(whole, 9)).decode("ascii")


def _coded(levels: Array, planes: int) -> bytes:
    """Code levels (n, d) column by column: differences, zigzag, a plane a byte, lowest first."""
    half, whole = 2.0 ** (8 * planes - 1), 2.0 ** (8 * planes)
    first = np.zeros((1, levels.shape[1]))
    steps = np.diff(np.concatenate([first, levels]), axis=0)
    steps = (steps + half) % whole - half
    zigzag = np.where(steps < 0, -2 * steps - 1, 2 * steps).astype(np.uint32).T
    return b"".join(
        (zigzag >> 8 * plane & 0xFF).astype(np.uint8).tobytes() for plane in range(planes)
    )
