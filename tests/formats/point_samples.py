"""Small files of points, written by hand and not by our writers."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np

Parameters = list[tuple[str, str, Any]]

INTEL, DEC, SGI = 84, 85, 86


def places(frames: int = 5, points: int = 3, seed: int = 0) -> np.ndarray:
    """Return places (F, J, 3) that are multiples of an eighth: whole numbers hold them, too."""
    return np.random.default_rng(seed).integers(-800, 800, (frames, points, 3)) / 8.0


def c3d(
    positions: np.ndarray,
    labels: Sequence[str] = ("LASI", "RASI", "SACR"),
    *,
    processor: int = INTEL,
    whole: bool = False,
    words: np.ndarray | None = None,
    analog: np.ndarray | None = None,
    rate: float = 100.0,
    more: Parameters = (),
    header: dict[int, int] | None = None,
    frames: int | None = None,
    width: int = 8,
) -> bytes:
    """Write a C3D of any processor.

    Parameters
    ----------
    positions : (F, J, 3) array
    labels : sequence of str
    processor : int
    whole : bool
        Whether frames hold whole numbers.
    words : (F, J) array, optional
        The fourth word of each point; 0 by default.
    analog : (F, samples a frame, channels) array, optional
    rate : float
    more : list of (group, name, value)
        Parameters besides those that every file has, in place of them where they are the same.
    header : dict, optional
        Words of the header that lie.
    frames : int, optional
        Frames that are written.
    width : int
        Letters of a label.
    """
    order = ">" if processor == SGI else "<"
    count, points = positions.shape[:2]
    channels = 0 if analog is None else analog.shape[2]
    per_frame = 0 if analog is None else analog.shape[1]
    scale = 0.125 if whole else -0.125
    told: dict[tuple[str, str], Any] = {
        ("POINT", "USED"): points,
        ("POINT", "SCALE"): scale,
        ("POINT", "RATE"): rate,
        ("POINT", "FRAMES"): min(count, 65535),
        ("POINT", "LABELS"): [label.ljust(width) for label in labels],
        ("POINT", "UNITS"): "mm  ",
    }
    told |= {(group, name): value for group, name, value in more}
    section = _section(told, processor, order)
    start = 2 + len(section) // 512
    head = [points, per_frame * channels, 1, min(count, 65535), 0]
    for at, word in (header or {}).items():
        head[at] = word
    first = struct.pack("BB", 2, 0x50) + struct.pack(f"{order}5H", *head)
    first += _reals([scale], processor, order)
    first += struct.pack(f"{order}HH", start, per_frame) + _reals([rate], processor, order)
    rows = np.zeros((count, points, 4))
    rows[..., :3] = positions / (scale if whole else 1.0)
    rows[..., 3] = 0.0 if words is None else words
    rows = rows.reshape(count, -1)
    if analog is not None:
        rows = np.hstack([rows, analog.reshape(count, -1)])
    body = rows[: count if frames is None else frames].ravel()
    data = body.astype(f"{order}i2").tobytes() if whole else _reals(body, processor, order)
    return first.ljust(512, b"\0") + section + data


def _reals(values: Any, processor: int, order: str) -> bytes:
    if processor != DEC:
        return np.asarray(values, f"{order}f4").tobytes()
    halves = np.asarray(np.asarray(values) * 4.0, "<f4").view("<u2").reshape(-1, 2)
    return halves[:, ::-1].tobytes()


def _section(told: dict[tuple[str, str], Any], processor: int, order: str) -> bytes:
    groups = list(dict.fromkeys(group for group, _ in told))
    body = b"".join(_entry(-n, group, b"", order) for n, group in enumerate(groups, 1))
    for (group, name), value in told.items():
        content = _content(value, processor, order)
        body += _entry(groups.index(group) + 1, name, content, order)
    blocks = -(-(len(body) + 6) // 512)
    return (struct.pack("4B", 1, 0x50, blocks, processor) + body).ljust(512 * blocks, b"\0")


def _entry(number: int, name: str, content: bytes, order: str) -> bytes:
    head = struct.pack("bb", len(name), number) + name.encode()
    return head + struct.pack(f"{order}h", len(content) + 3) + content + b"\0"


def _content(value: Any, processor: int, order: str) -> bytes:
    if isinstance(value, bytes):
        return value
    if isinstance(value, str):
        return struct.pack("bBB", -1, 1, len(value)) + value.encode()
    if isinstance(value, list) and value and isinstance(value[0], str):
        width = max(len(text.encode()) for text in value)
        texts = b"".join(text.encode().ljust(width) for text in value)
        return struct.pack("bBBB", -1, 2, width, len(value)) + texts
    if isinstance(value, int):
        return struct.pack("bB", 2, 0) + struct.pack(f"{order}H", value % 65536)
    if isinstance(value, float):
        return struct.pack("bB", 4, 0) + _reals([value], processor, order)
    array = np.asarray(value)
    shape = struct.pack("B", array.ndim) + bytes(array.shape[::-1])
    if array.dtype.kind == "f":
        return struct.pack("b", 4) + shape + _reals(array.ravel(), processor, order)
    return struct.pack("b", 2) + shape + array.astype(f"{order}i2").tobytes()


TRC = (
    "PathFileType\t4\t(X/Y/Z)\twalk.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
    "OrigNumFrames\n"
    "100.00\t100.00\t3\t2\tmm\t100.00\t1\t3\n"
    "Frame#\tTime\tR.ASIS\t\t\tL.ASIS\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n"
    "\n"
    "1\t0.000\t1.5\t2.5\t3.5\t4.5\t5.5\t6.5\n"
    "2\t0.010\t\t\t\t4.6\t5.5\t6.5\n"
    "3\t0.020\t1.7\t2.5\t3.5\t4.7\t5.5\t6.5\n"
)

STO = (
    "markers\nversion=1\nnRows=3\nnColumns=7\ninDegrees=no\nendheader\n"
    "time\ta_tx\ta_ty\ta_tz\tb_tx\tb_ty\tb_tz\n"
    "0\t1\t2\t3\t4\t5\t6\n0.01\t1.1\tnan\t3\t4\t5\t6\n0.02\t1.2\t2\t3\t4\t5\t6\n"
)

VEC3 = (
    "DataRate=100.000000\nDataType=Vec3\nversion=3\nOpenSimVersion=4.4\nendheader\n"
    "time\ta\tb\n0.00\t1,2,3\t4,5,6\n0.01\t1.5,2,3\t4,5,6\n"
)

QUALISYS = (
    "NO_OF_FRAMES\t3\nNO_OF_CAMERAS\t8\nNO_OF_MARKERS\t2\nFREQUENCY\t200\nNO_OF_ANALOG\t0\n"
    "ANALOG_FREQUENCY\t0\nDESCRIPTION\t--\nTIME_STAMP\t2024-01-01, 12:00:00\nDATA_INCLUDED\t3D\n"
    "EVENT\tstart\t1\t0.005\n"
    "MARKER_NAMES\tL_IAS\tR_IAS\n"
    "1.5\t2\t3\t4\t5\t6\n0.000\t0.000\t0.000\t4\t5\t6\n1.7\t2\t3\t4\t5\t6\n"
)

MOTIVE = (
    "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,120.0,Export Frame Rate,60.0,"
    "Total Exported Frames,3,Rotation Type,Quaternion,Length Units,Meters\n"
    "\n"
    ",,Bone,Bone,Bone,Bone,Bone,Bone,Bone,Marker,Marker,Marker,Marker,Marker,Marker\n"
    ",,A:Hip,A:Hip,A:Hip,A:Hip,A:Hip,A:Hip,A:Hip,A:Hip1,A:Hip1,A:Hip1,Unlabeled 7,Unlabeled 7,"
    "Unlabeled 7\n"
    ",,1,1,1,1,1,1,1,2,2,2,3,3,3\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Position,Position,Position,"
    "Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,X,Y,Z,X,Y,Z\n"
    "0,0.0,0,0,0,1,7,8,9,1.5,2,3,4,5,6\n"
    "1,0.016667,0,0,0,1,7,8,9,,,,4,5,6\n"
    "2,0.033333,0,0,0,1,7,8,9,1.7,2,3,4,5,6\n"
)

DEEPLABCUT = (
    "scorer,net,net,net,net,net,net\nbodyparts,nose,nose,nose,tail,tail,tail\n"
    "coords,x,y,likelihood,x,y,likelihood\n"
    "0,100.5,200,0.9,300,400,0.8\n1,101.5,200,0.9,,,\n2,102.5,200,0.1,300,400,0.8\n"
)

CSV = "frame,time,a_x,a_y,a_z,b_x,b_y,b_z\n1,0,1.5,2,3,4,5,6\n2,0.02,,,,4,5,6\n3,0.04,1,2,3,4,5,6\n"
