"""Poses of FBX and glTF files as we read them, beside those of Blender's importers."""

from __future__ import annotations

import json
import subprocess
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics

__all__ = ["DEGREES", "HEIGHT", "SCRIPT", "Compared", "compared", "made"]

Array = NDArray[np.float64]

SCRIPT = Path(__file__).resolve().parent / "inside" / "scenes.py"
# What poses may differ by: degrees, and parts of the body's size.
DEGREES, HEIGHT = 0.1, 0.001
# What axes may miss quarter turns by.
_AXIS = 1e-3


@dataclass(frozen=True)
class Compared:
    """How far poses of one file lie apart.

    Parameters
    ----------
    file : str
    kind : str
        Its suffix without the dot.
    poses, joints : int
        That were compared.
    degrees : float
        The largest difference of a joint's rotation in the world since the first pose.
    height : float
        The largest distance of a joint, in body sizes.
    error : str
    """

    file: str
    kind: str
    poses: int = 0
    joints: int = 0
    degrees: float = float("nan")
    height: float = float("nan")
    error: str = ""

    @property
    def equal(self) -> bool:
        """Whether poses are equal as far as was asked."""
        return self.degrees <= DEGREES and self.height <= HEIGHT


def made(python: Path, folder: Path) -> list[Path]:
    """Write files of all rows by one Blender; return them."""
    _run(python, "make", folder)
    return [path for path in sorted(folder.iterdir()) if path.suffix in (".fbx", ".glb", ".gltf")]


def compared(python: Path, files: Sequence[Path], folder: Path, last: Path) -> list[Compared]:
    """Compare our poses of files with those of one Blender's importers.

    Where they differ, the newer importer of another Blender is asked.
    """
    motions: dict[Path, Any] = {}
    for path in files:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rl.RoundelayWarning)
            try:
                motions[path] = rl.read(path), _first_animation(path)
            except rl.RoundelayError as error:
                motions[path] = str(error)
    rows = _imported(python, motions, folder, "usual")
    unlike = {path: motions[path] for path, row in rows.items() if _asks_again(path, row)}
    for path, row in _imported(last, unlike, folder, "new").items():
        rows[path] = row if row.equal else rows[path]
    return list(rows.values())


def _asks_again(path: Path, row: Compared) -> bool:
    """Tell whether Blender's other importer of FBX is asked."""
    return path.suffix == ".fbx" and not row.equal


def _imported(
    python: Path, motions: dict[Path, Any], folder: Path, importer: str
) -> dict[Path, Compared]:
    """Compare with one of Blender's importers, of which it has two for FBX."""
    jobs = [
        {
            "file": str(path),
            "out": str(folder / f"{path.name}.{importer}.npz"),
            "fps": max(1, round(found[0].fps)),
            "animation": found[1],
            "importer": importer,
        }
        for path, found in motions.items()
        if not isinstance(found, str)
    ]
    listed = folder / "jobs.json"
    listed.write_text(json.dumps(jobs))
    told = _run(python, "poses", listed) if jobs else {}
    return {path: _row(path, found, folder, importer, told) for path, found in motions.items()}


def _first_animation(path: Path) -> str | None:
    """Return the name of the animation that is read by itself."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rl.read(path)
    for one in caught:
        text = str(one.message)
        if "animation '" in text and "' is read" in text:
            return text.split("animation '")[1].split("' is read")[0]
    return None


def _run(python: Path, *words: Any) -> dict[str, str]:
    """Run a script inside Blender; return what it says of files that went wrong."""
    command = [str(python), str(SCRIPT), *map(str, words)]
    shown = subprocess.run(command, capture_output=True, text=True, check=False)
    faults = {}
    for line in shown.stdout.splitlines():
        if line.startswith('{"file"'):
            told = json.loads(line)
            faults[told["file"]] = told["error"]
    return faults


def _row(path: Path, found: Any, folder: Path, importer: str, told: dict[str, str]) -> Compared:
    kind = "fbx" if path.suffix == ".fbx" else "glb"
    if isinstance(found, str):
        return Compared(path.name, kind, error=found)
    dumped = folder / f"{path.name}.{importer}.npz"
    if not dumped.is_file():
        return Compared(path.name, kind, error=f"Blender: {told.get(path.name, 'no poses')}")
    with np.load(dumped) as theirs:
        return _measured(path.name, kind, found[0], dict(theirs))


def _measured(name: str, kind: str, motion: rl.Motion, theirs: dict[str, Array]) -> Compared:
    frames = theirs["seconds"] * motion.fps
    inside = frames <= len(motion) - 0.5
    ours = motion.at(frames[inside])
    places, turns = forward_kinematics(
        ours.skeleton, ours.rotations, ours.root_path, translations=ours.translations
    )
    names, own = list(theirs["names"]), list(motion.skeleton.names)
    if not set(own) & set(names):
        # Nodes without a name are called otherwise in Blender.
        names, own = ([_plain(name) for name in each] for each in (names, own))
    common = [joint for joint in own if joint in names]
    left = [own.index(joint) for joint in common]
    right = [names.index(joint) for joint in common]
    a, b = places[:, left], theirs["places"][inside][:, right]
    if len(common) < 0.5 * min(len(names), motion.skeleton.n_joints):
        return Compared(name, kind, error=f"{len(common)} joints of one name")
    scale, axes, shift = _similarity(a, b)
    away = np.linalg.norm(scale * a @ axes.T + shift - b, axis=-1).max()
    ours_since = rot.multiply(turns[:, left], rot.conjugate(turns[:1, left]))
    seen = theirs["turns"][inside][:, right]
    theirs_since = rot.multiply(seen, rot.conjugate(seen[:1]))
    world = rot.from_matrix(axes)
    moved = rot.multiply(rot.multiply(world, ours_since), rot.conjugate(world))
    degrees = np.degrees(rot.angle_between(moved, theirs_since)).max()
    height = float(away / (scale * motion.skeleton.size))
    return Compared(name, kind, int(inside.sum()), len(common), float(degrees), height)


def _plain(name: str) -> str:
    return name.lower().replace("_", "")


def _similarity(a: Array, b: Array) -> tuple[float, Array, Array]:
    """Return scale, axes and shift that take places of ours to theirs: whole quarter turns.

    The scale and the axes are what importers choose; whether the poses are the same is another
    question.
    """
    p, q = a.reshape(-1, 3), b.reshape(-1, 3)
    pm, qm = p.mean(axis=0), q.mean(axis=0)
    u, _, v = np.linalg.svd((q - qm).T @ (p - pm))
    axes = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ v))]) @ v
    whole = np.rint(axes)
    if np.abs(axes - whole).max() < _AXIS:
        axes = whole
    scale = float(np.sqrt(((q - qm) ** 2).sum() / ((p - pm) ** 2).sum()))
    return scale, axes, qm - scale * axes @ pm
