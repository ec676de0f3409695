"""What must hold of every input: a sane motion that can be written and read again, or one error."""

from __future__ import annotations

import random
import tempfile
import warnings
from pathlib import Path

import numpy as np
from tests.fuzz.chance import Files

import roundelay as rl
from roundelay.formats import suffixes_of, writers
from roundelay.formats.registry import PointsReader, reader_of
from roundelay.formats.sane import fault_of
from roundelay.motion.points import Points

__all__ = ["changed", "outcome"]

# One of so many files of points is read as a motion, too, which takes ten times as long.
_AS_MOTIONS = 10


def outcome(files: Files) -> str:
    """Read the files of a capture: "accepted", "refused", or what went wrong."""
    with tempfile.TemporaryDirectory() as place, warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        folder = Path(place)
        for name, content in files.items():
            (folder / name).write_bytes(content)
        path = folder / next(iter(files))
        points = isinstance(reader_of(path), PointsReader)
        try:
            found = rl.read_points(path) if points else rl.read(path)
        except rl.FormatError as error:
            return "refused" if str(path.parent) in str(error) else f"no file in: {error}"
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        try:
            if isinstance(found, Points):
                return _points_came_back(found, path)
            return _came_back(found, folder / f"again{_written(path.suffix)}")
        except Exception as error:
            return f"written again: {type(error).__name__}: {error}"


def _written(suffix: str) -> str:
    """Return the suffix of a file of the same kind that there is a writer of."""
    return suffix if suffix in suffixes_of(writers) else ".glb"


def _points_came_back(points: Points, path: Path) -> str:
    """Write points that were read, and read them again; and read them as a motion."""
    writer = next((one for one in writers if path.suffix in one.suffixes), None)
    writer = writer or next(one for one in writers if ".npz" in one.suffixes)
    place = path.with_name(f"again{writer.suffixes[0]}")
    writer.write_points(points, place)
    again = rl.read_points(place)
    if len(again) != len(points) or not np.isclose(again.fps, points.fps, rtol=1e-6):
        return f"frames or rate changed: {points!r} to {again!r}"
    if not np.array_equal(again.missing, points.missing):
        return f"gaps changed: {points!r} to {again!r}"
    apart = np.abs(again.positions[..., : points.dimensions] - points.positions).max()
    if apart > 1e-7 * (1.0 + np.abs(points.positions).max()):
        return f"places changed: {apart}"
    if path.stat().st_size % _AS_MOTIONS:
        return "accepted"
    try:
        fault = fault_of(rl.read(path))
    except rl.FormatError:
        return "accepted"
    return f"not sane: {fault}" if fault else "accepted"


def _came_back(motion: rl.Motion, path: Path) -> str:
    """Write a motion that was read, and read it again."""
    fault = fault_of(motion)
    if fault is not None:
        return f"not sane: {fault}"
    rl.write(motion, path)
    again = rl.read(path)
    if len(again) != len(motion) or not np.isclose(again.fps, motion.fps, rtol=1e-4):
        return f"frames or rate changed: {motion!r} to {again!r}"
    if motion.skeleton.n_joints > again.skeleton.n_joints:
        return f"joints lost: {motion!r} to {again!r}"
    return "accepted" if _apart(motion, again) <= 1.0 else f"poses changed: {_apart(motion, again)}"


def _apart(motion: rl.Motion, again: rl.Motion) -> float:
    """Return how far poses lie apart, in what single precision and eight decimals allow."""
    ours, theirs = motion.positions(), again.positions()
    count = motion.skeleton.n_joints
    names = {name: joint for joint, name in enumerate(again.skeleton.names)}
    joints = [names.get(name, joint) for joint, name in enumerate(motion.skeleton.names)]
    allowed = 1e-6 * count * (np.abs(ours).max() + motion.skeleton.size) + 1e-7 * count
    up = np.eye(3)[[motion.up, again.up]]
    if motion.up != again.up:  # a glTF stands on its Y axis: heights are compared
        ours, theirs = ours @ up[0], theirs @ up[1]
    return float(np.abs(ours - theirs[:, joints]).max() / allowed)


def changed(files: Files, seed: int, others: list[Files]) -> Files:
    """Change one of the files in one to four places, by itself or with pieces of others."""
    chance = random.Random(seed)
    name = chance.choice(list(files))
    data = bytearray(files[name])
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(data) + 1)
        length = chance.choice((1, 2, 4, 16, 100))
        piece = b"".join(chance.choice(others).values())
        start = chance.randrange(len(piece) + 1)
        match chance.randrange(5):
            case 0:
                data[at : at + 1] = bytes([chance.randrange(256)])
            case 1:
                del data[at : at + length]
            case 2:
                data[at:at] = data[at : at + length]
            case 3:
                data[at:at] = piece[start : start + length]
            case _:
                data[at : at + length] = piece[start : start + length]
    return {**files, name: bytes(data)}
