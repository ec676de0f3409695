"""The page's data, unpacked as its script does."""

from __future__ import annotations

import base64
import json
import zlib

import numpy as np


def unpacked(text: str) -> tuple[dict, bytes]:
    whole = zlib.decompress(base64.b64decode(text))
    length = int.from_bytes(whole[:4], "little")
    return json.loads(whole[4 : 4 + length]), whole[4 + length :]


def values(reference: dict, data: bytes) -> np.ndarray:
    rows, columns = reference["rows"], len(reference["low"])
    count, at = rows * columns, reference["at"]
    planes = [
        np.frombuffer(data, np.uint8, count, at + plane * count).astype(int) << 8 * plane
        for plane in range(reference["planes"])
    ]
    code = sum(planes).reshape(columns, rows)
    steps = np.where(code & 1, -(code + 1) // 2, code // 2)
    levels = np.cumsum(steps, axis=1) & (256 ** reference["planes"] - 1)
    return levels.T * reference["step"] + reference["low"]
