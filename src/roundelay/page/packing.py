"""Packing of the page's data: numbers to 16 bits, everything deflated into one text."""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Packer"]

_LEVELS = 65535


class Packer:
    """Collect arrays; then write them, with the document that refers to them, as one text.

    An array becomes 16-bit steps within the range of each column, and the differences from one
    row to the next, which deflate well. Its place in the document is a reference::

        {"at": byte offset, "rows": n, "low": [one a column], "step": [one a column]}
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
        place = self._append(_coded(np.round((table - low) / step)))
        rounded = [[float(f"{value:.8g}") for value in column] for column in (low, step)]
        return {"at": place, "rows": len(table), "low": rounded[0], "step": rounded[1]}

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


def _coded(levels: NDArray[np.float64]) -> bytes:
    """Code levels (n, d) in [0, 65535] column by column: differences, zigzag, low bytes first."""
    first = np.zeros((1, levels.shape[1]))
    steps = np.diff(np.concatenate([first, levels]), axis=0)
    steps = (steps + 32768.0) % 65536.0 - 32768.0
    zigzag = np.where(steps < 0, -2 * steps - 1, 2 * steps).astype(np.uint16).T
    return (zigzag & 0xFF).astype(np.uint8).tobytes() + (zigzag >> 8).astype(np.uint8).tobytes()
