"""The one buffer of a glTF file that is written: arrays and pictures, one after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Buffer"]

Json = dict[str, Any]

_TYPES = {"<f4": 5126, "<u4": 5125, "<u2": 5123}


class Buffer:
    """Arrays, by default of 32-bit floats, with their accessors."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[Json] = []
        self.accessors: list[Json] = []

    def add(
        self, kind: str, values: NDArray[Any], *, dtype: str = "<f4", limits: bool = False
    ) -> int:
        """Append values (n, ...) of a kind such as "VEC3"; return the accessor's number."""
        rows = np.ascontiguousarray(values, dtype).reshape(len(values), -1)
        number = len(self.accessors)
        view = self.view(rows.tobytes())
        accessor = {
            "bufferView": view,
            "componentType": _TYPES[dtype],
            "count": len(rows),
            "type": kind,
        }
        if limits:
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return number

    def view(self, content: bytes) -> int:
        """Append bytes; return the number of their view."""
        self.data += bytes(-len(self.data) % 4)
        number = len(self.views)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(content)})
        self.data += content
        return number
