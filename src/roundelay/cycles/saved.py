"""Cycles as files: NPZ of plain arrays, with a version, checked when they are read.

What a cycle was found by stays with its capture: a cycle that is read again can be sampled,
blended, styled and followed live, and has no repetitions. Nothing in a file is run.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from io import BytesIO
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import written_beside
from roundelay.cycles.above import Above
from roundelay.cycles.cycle import Cycle
from roundelay.formats.arrays import arrays_of
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.floating import PointsLayout
from roundelay.phase.harmonic import HarmonicCurve

__all__ = ["VERSION", "load_cycle", "save_cycle"]

Array = NDArray[np.float64]
Arrays = dict[str, NDArray[Any]]

VERSION = 1
# Curves and how many values each has: of J joints, and besides.
_CURVES = {
    "pose": (4, 0),
    "odd_pose": (4, 0),
    "velocity": (0, 3),
    "height": (0, 1),
    "translations": (3, 0),
}
_PARTS = ("frequencies", "constant", "sine", "cosine")
_NUMBERS = ("period", "turning", "fps")
_KINDS = {
    "roundelay_cycle": "iu",
    "names": "U",
    "parents": "i",
    "offsets": "f",
    "end_joints": "iu",
    "end_offsets": "f",
    "free": "b",
    "units": "U",
    "image": "b",
    "links": "i",
    "up": "iu",
    "name": "U",
    "method": "U",
    "phase": "f",
    "above_rotations": "f",
    "above_places": "f",
    "above_travels": "b",
    "above_turns": "b",
    **dict.fromkeys(_NUMBERS, "f"),
    **{f"{curve}_{part}": "f" for curve in _CURVES for part in _PARTS},
}


def save_cycle(cycle: Cycle, path: str | Path) -> None:
    """Write a cycle to a file, whole or not at all.

    Parameters
    ----------
    cycle : Cycle
    path : path-like
        Its suffix is .npz.

    Raises
    ------
    ValueError
        If the suffix is another.
    OSError
        If it cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != ".npz":
        raise ValueError(f"expected a file of type .npz, found {path.name!r}")
    held, arrays = BytesIO(), dict[str, Any](_told(cycle))
    np.savez_compressed(held, **arrays)
    with written_beside(path) as part:
        part.write_bytes(held.getvalue())


def _told(cycle: Cycle) -> Iterator[tuple[str, NDArray[Any]]]:
    skeleton, layout = cycle.skeleton, cycle.skeleton.layout
    yield "roundelay_cycle", np.array(VERSION)
    yield "names", np.array(skeleton.names)
    yield "parents", np.array(skeleton.parents, int)
    yield "offsets", skeleton.offsets
    yield "end_joints", np.array([joint for joint, _ in skeleton.end_sites], int)
    ends = [offset for _, offset in skeleton.end_sites]
    yield "end_offsets", np.array(ends, float).reshape(-1, 3)
    yield "free", np.array(skeleton.free)
    if isinstance(layout, PointsLayout):
        yield "units", np.array(layout.units)
        yield "image", np.array(layout.image)
        yield "links", np.array(layout.links, int).reshape(-1, 2)
    yield "up", np.array(cycle.up)
    yield "name", np.array(cycle.name)
    yield "method", np.array(cycle.method)
    for number in _NUMBERS:
        yield number, np.array(float(getattr(cycle, number)))
    for name in _CURVES:
        curve = getattr(cycle, name)
        for part in _PARTS if curve is not None else ():
            yield f"{name}_{part}", getattr(curve, part)
    if cycle.phase is not None:
        yield "phase", cycle.phase
    for part in ("rotations", "places", "travels", "turns") if cycle.above else ():
        yield f"above_{part}", getattr(cycle.above, part)


def load_cycle(path: str | Path) -> Cycle:
    """Read a cycle that `save_cycle` wrote.

    Parameters
    ----------
    path : path-like

    Raises
    ------
    FormatError
        If it is no cycle, of a later version, or what it holds does not go together.
    OSError
        If it cannot be read.
    """
    path = Path(path)
    arrays = arrays_of(path, _KINDS)
    version = arrays.get("roundelay_cycle")
    if version is None or version.shape:
        raise FormatError("expected a cycle saved by roundelay, found another NPZ", path=path)
    if not 1 <= int(version) <= VERSION:
        raise FormatError(
            f"expected version {VERSION} or earlier, found {int(version)}: "
            "it was saved by a later roundelay",
            path=path,
        )
    try:
        return _made(arrays)
    except KeyError as error:
        raise FormatError(f"expected an array {error}, found none", path=path) from None
    except (ValueError, IndexError, zipfile.BadZipFile) as error:
        raise FormatError(f"expected a whole cycle, found: {error}", path=path) from None


def _made(arrays: Arrays) -> Cycle:
    skeleton = _skeleton(arrays)
    numbers = {name: float(_sized(arrays, name, ())) for name in _NUMBERS}
    if not (all(map(isfinite, numbers.values())) and min(numbers["period"], numbers["fps"]) > 0.0):
        raise ValueError(f"period, turning and rate of {', '.join(map(str, numbers.values()))}")
    up = int(_sized(arrays, "up", ()))
    if up not in (0, 1, 2):
        raise ValueError(f"axis {up} that points up")
    curves: dict[str, Any] = {name: _curve(arrays, name, skeleton.n_joints) for name in _CURVES}
    for name in ("pose", "velocity", "height"):
        if curves[name] is None:
            raise KeyError(f"{name}_constant")
    return Cycle(
        skeleton=skeleton,
        up=up,
        name=str(arrays.get("name", "")),
        method=str(arrays.get("method", "")),
        above=_above(arrays),
        phase=arrays.get("phase"),
        **curves,
        period=numbers["period"],
        turning=numbers["turning"],
        fps=numbers["fps"],
    )


def _skeleton(arrays: Arrays) -> Skeleton:
    names = tuple(str(name) for name in arrays["names"])
    ends = _sized(arrays, "end_offsets", (len(arrays["end_joints"]), 3))
    free, layout = bool(_sized(arrays, "free", ())), None
    if free:
        links = tuple((int(a), int(b)) for a, b in arrays["links"])
        units, image = str(arrays["units"]), bool(arrays["image"])
        layout = PointsLayout(names[1:], 2 if image else 3, units, image, links, None, ())
    return Skeleton(
        names,
        tuple(int(parent) for parent in arrays["parents"]),
        np.asarray(arrays["offsets"], float),
        tuple((int(joint), end) for joint, end in zip(arrays["end_joints"], ends, strict=True)),
        layout=layout,
        free=free,
    )


def _curve(arrays: Arrays, name: str, joints: int) -> HarmonicCurve | None:
    if f"{name}_constant" not in arrays:
        return None
    each, besides = _CURVES[name]
    width, count = each * joints + besides, len(arrays[f"{name}_frequencies"])
    shapes = ((count,), (width,), (count, width), (count, width))
    parts = [
        np.asarray(_sized(arrays, f"{name}_{part}", shape), float)
        for part, shape in zip(_PARTS, shapes, strict=True)
    ]
    if not all(np.isfinite(part).all() for part in parts):
        raise ValueError(f"a {name} that is not finite")
    return HarmonicCurve(*parts)


def _above(arrays: Arrays) -> Above | None:
    if "above_rotations" not in arrays:
        return None
    count = len(arrays["above_rotations"])
    shapes = {"rotations": (count, 4), "places": (count, 3), "travels": (count,), "turns": (count,)}
    return Above(*(_sized(arrays, f"above_{part}", shape) for part, shape in shapes.items()))


def _sized(arrays: Arrays, name: str, shape: tuple[int, ...]) -> NDArray[Any]:
    if arrays[name].shape != shape:
        raise ValueError(f"{name} of shape {arrays[name].shape} for {shape}")
    return arrays[name]
