"""Read and write USD: a skeleton of UsdSkel and its animation, by the library usd-core.

It comes with the extra ``usd``. Files are read in a process of its own, see
`roundelay.formats.apart`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import content, name_of, written_beside
from roundelay.formats.apart import Library, read_apart
from roundelay.formats.arrays import arrays_of
from roundelay.formats.contents import Contents
from roundelay.formats.nodes import Tree, called, different, listed, note
from roundelay.formats.options import ReadOptions
from roundelay.formats.posed import Chosen, even_scales, matrix_of, posed
from roundelay.formats.sane import LARGEST, fault_of_size, require_memory
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion

__all__ = ["UsdReader", "UsdWriter"]

Array = NDArray[np.float64]

_LIBRARY = Library(
    name="usd-core",
    module="pxr",
    extra="usd",
    child="roundelay.formats.usd_child",
    holds="a USD with an animated skeleton",
)
_KINDS = dict.fromkeys(("rest", "local", "world", "step", "metres"), "f") | {"parents": "i"}
_KINDS |= dict.fromkeys(("skeletons", "joints", "up"), "U")
_SUFFIXES = (".usda", ".usdc", ".usd", ".usdz")
_ODD = re.compile(r"[^A-Za-z0-9_]")


class UsdReader:
    """The reader of USD files."""

    name = "usd"
    suffixes = _SUFFIXES
    choices = frozenset({"character"})

    def read(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read a USD file.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which skeleton; the first by default.

        Returns
        -------
        Motion
            Lengths and axes are those of the file.

        Raises
        ------
        FormatError
            If the file is not sound, holds no animated skeleton, or usd-core is not installed.
        OSError
            If it cannot be read.
        """
        character = "-" if wanted is None or wanted.character is None else wanted.character
        arrays = _read_apart(path, character)
        names = [str(name) for name in arrays["skeletons"]]
        if character != "-":
            called("a skeleton (--character)", names, character, path)
        elif len(names) > 1:
            others = listed([repr(name) for name in names[1:]])
            note(path, f"skeleton {names[0]!r} is read, not {others} (--character names another)")
        return _motion(path, arrays)

    def contents(self, path: Path) -> Contents:
        """List the skeletons of a file, and what it says of its axes and unit."""
        arrays = _read_apart(path, "-")
        told = {"up": str(arrays["up"]), "unit": f"{float(arrays['metres']):g} m"}
        return Contents(characters=tuple(map(str, arrays["skeletons"])), conventions=told)


def _read_apart(path: Path, character: str) -> dict[str, NDArray[Any]]:
    """Read a file in another process.

    Raises
    ------
    FormatError
        If there is no usd-core, or it cannot read the file, dies or takes too long.
    """
    suffix = next((one for one in _SUFFIXES if one in path.suffixes), ".usd")
    with read_apart(_LIBRARY, path, content(path), suffix, [character]) as made:
        return arrays_of(made, _KINDS)


def _motion(path: Path, arrays: dict[str, NDArray[Any]]) -> Motion:
    """Return the motion of a skeleton below its own node, which carries it through the world."""
    local, joints = arrays["local"], [str(one) for one in arrays["joints"]]
    fault = fault_of_size(len(local), len(joints))
    if fault is not None:
        raise FormatError(fault, path=path)
    require_memory(len(local), len(joints))
    matrices = np.concatenate([arrays["world"][:, None], local], axis=1)
    rest = np.concatenate([arrays["world"][:1], arrays["rest"]])
    if not np.all(np.abs(matrices) <= LARGEST) or not np.all(np.abs(rest) <= LARGEST):
        raise FormatError(
            f"expected finite numbers of at most {LARGEST:g}, found others", path=path
        )
    names = ["", *(joint.rpartition("/")[2] for joint in joints)]
    tree = Tree.of(path, names, [-1, *(int(n) + 1 for n in arrays["parents"])])
    # Parents stand first in USD.
    order = sorted(tree.with_descendants({1}))
    placed = _Placed.of(tree, np.concatenate([rest[None], matrices]))
    return posed(tree, placed, Chosen(order, []), float(arrays["step"]), name_of(path))


@dataclass(frozen=True, eq=False)
class _Placed:
    """Matrices taken apart: at rest, then in every frame."""

    at: Array
    turned: Array
    scales: dict[int, float]
    matrices: Array

    @classmethod
    def of(cls, tree: Tree, matrices: Array) -> _Placed:
        # Rows are vectors in USD: the place stands in the last row.
        columns = matrices.swapaxes(-1, -2)
        sizes = np.linalg.norm(columns[..., :3, :3], axis=-2)
        shown = {node: sizes[1:, node] for node in range(columns.shape[1])}
        units = columns[..., :3, :3] / np.where(sizes > 0.0, sizes, 1.0)[..., None, :]
        left, _, right = np.linalg.svd(units)
        side = np.sign(np.linalg.det(left @ right))
        right[..., 2, :] *= side[..., None]
        turns = rot.from_matrix(left @ right)
        return cls(columns[..., :3, 3], turns, even_scales(tree, shown), columns)

    def places(self, node: int) -> Array:
        return self.at[:, node]

    def turns(self, node: int) -> Array:
        return self.turned[:, node]

    def scale(self, node: int) -> float:
        return self.scales[node]

    def local(self, node: int) -> Array:
        return np.asarray(self.matrices[0, node])


class UsdWriter:
    """The writer of USD files."""

    name = "usd"
    suffixes = (".usda", ".usdc", ".usd")
    # Samples stand at times, and a clip lasts from the first to the last.
    wraps_at_last_key = True

    def write(self, motion: Motion, path: Path) -> None:
        """Write a USD file: a skeleton and its animation, each frame a sample.

        Lengths keep the motion's unit, which the file does not tell; the axis that points up is
        told. Names get letters that USD allows.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        _LIBRARY.require(path)
        with written_beside(path) as part:
            _save(motion, part)


def _save(motion: Motion, path: Path) -> None:
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, "XYZ"[motion.up])
    stage.SetTimeCodesPerSecond(motion.fps)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(len(motion) - 1)
    root = UsdSkel.Root.Define(stage, "/Body")
    stage.SetDefaultPrim(root.GetPrim())
    skeleton = UsdSkel.Skeleton.Define(stage, "/Body/Skeleton")
    animation = UsdSkel.Animation.Define(stage, "/Body/Skeleton/Animation")
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(
        [Sdf.Path("/Body/Skeleton/Animation")]
    )
    joints = _paths(motion)
    offsets = motion.skeleton.offsets
    rest = [matrix_of(place, rot.identity(), np.ones(3)).T for place in offsets]
    world = _worlds(motion, rest)
    skeleton.CreateJointsAttr(joints)
    animation.CreateJointsAttr(joints)
    skeleton.CreateRestTransformsAttr(Vt.Matrix4dArray([Gf.Matrix4d(m.tolist()) for m in rest]))
    skeleton.CreateBindTransformsAttr(Vt.Matrix4dArray([Gf.Matrix4d(m.tolist()) for m in world]))
    animation.CreateScalesAttr(Vt.Vec3hArray.FromNumpy(np.ones((len(joints), 3), np.float16)))
    turns, places = animation.CreateRotationsAttr(), animation.CreateTranslationsAttr()
    moved = motion.translations
    for frame in range(len(motion)):
        at = np.array(offsets if moved is None else moved[frame], np.float32)
        at[0] = motion.root_path[frame]
        places.Set(Vt.Vec3fArray.FromNumpy(at), frame)
        xyzw = np.roll(motion.rotations[frame], -1, axis=-1).astype(np.float32)
        turns.Set(Vt.QuatfArray.FromNumpy(np.ascontiguousarray(xyzw)), frame)
    stage.GetRootLayer().Save()


def _paths(motion: Motion) -> list[str]:
    """Return the joints as USD names them: by the way from the root."""
    plain = [_ODD.sub("_", name) or "_" for name in motion.skeleton.names]
    plain = [f"_{name}" if name[0].isdigit() else name for name in plain]
    paths: list[str] = []
    for name, parent in zip(different(plain), motion.skeleton.parents, strict=True):
        paths.append(f"{paths[parent]}/{name}" if parent >= 0 else name)
    return paths


def _worlds(motion: Motion, rest: list[Array]) -> list[Array]:
    """Return the matrices of the joints at rest in the world, rows as vectors."""
    found: list[Array] = []
    for matrix, parent in zip(rest, motion.skeleton.parents, strict=True):
        found.append(matrix @ found[parent] if parent >= 0 else matrix)
    return found
