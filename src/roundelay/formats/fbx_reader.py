"""Read FBX: the limb nodes as the skeleton, an animation at even times as the motion.

Without limb nodes or a skin the skeleton is made of the models that the animation moves and what
hangs on them. Lengths become centimetres, whatever unit the file has.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from roundelay.formats.clock import Clock, common_clock
from roundelay.formats.contents import Contents
from roundelay.formats.fbx_document import Fbx, Properties, load
from roundelay.formats.fbx_figure import read_figure
from roundelay.formats.fbx_models import Models, PlacedModels, models_of
from roundelay.formats.fbx_takes import Channel, Take, takes_of
from roundelay.formats.nodes import Tree, called, different, listed, note
from roundelay.formats.options import ReadOptions
from roundelay.formats.posed import Chosen, check_proportion, even_scales, posed
from roundelay.motion.motion import Motion

__all__ = ["FbxReader"]

_MOVING = "an animation that moves the skeleton's models"
_BESIDES = {"Geometry": "meshes", "Material": "materials", "Texture": "textures"}
_UNITS = (1e-6, 1e6)
_Channels = dict[tuple[Hashable, str], Channel]


class FbxReader:
    """The reader of FBX files."""

    name = "fbx"
    suffixes = (".fbx",)
    choices = frozenset({"animation", "character"})

    def read(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read an FBX file, binary or text, of version 6.1 to 7.7.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which animation and which skeleton.

        Returns
        -------
        Motion
            The first animation that moves the skeleton, or the one that is wanted, on the axes of
            the file; lengths in centimetres.

        Raises
        ------
        FormatError
            If the file is not sound, encrypted, or holds no animation of models, or not what is
            wanted.
        OSError
            If it cannot be read.
        """
        wanted = wanted or ReadOptions()
        fbx = load(path)
        models = models_of(fbx)
        bones = _bones(models, wanted.character)
        channels = _animation(models, bones, wanted.animation)
        moving = {models.number[one] for one, _ in channels if one in models.number}
        joints = models.tree.connected(bones or models.tree.with_descendants(moving))
        nodes = [*models.tree.above(joints[0]), *joints]
        used = {
            key: channel
            for key, channel in channels.items()
            if models.number.get(key[0], -1) in set(nodes)
        }
        if not used:
            raise fbx.error(_MOVING, "none")
        return _posed(models, joints, moving, used, _clock(fbx, used), path.stem)

    def read_still(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read the skeleton at rest, with its meshes, as a motion of one frame.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which skeleton.

        Raises
        ------
        FormatError
            If the file is not sound, encrypted, or holds no skeleton.
        OSError
            If it cannot be read.
        """
        models = models_of(load(path))
        bones = _bones(models, (wanted or ReadOptions()).character)
        if not models.tree.order:
            raise models.fbx.error("a skeleton", "none")
        joints = models.tree.connected(bones or set(models.tree.order))
        return _posed(models, joints, set(), {}, Clock(np.zeros(1), 1.0), path.stem)

    def contents(self, path: Path) -> Contents:
        """List the animations and skeletons of a file, and what it says of its axes and unit."""
        fbx = load(path)
        models = models_of(fbx)
        names = different([take.name for take in takes_of(fbx)])
        return Contents(names, tuple(models.tree.roots(models.bones())), _conventions(fbx))

    def besides_motion(self, path: Path) -> tuple[str, ...]:
        """Name what a file holds that its motion does not: see `Reader`."""
        fbx = load(path)
        named = [told for kind, told in _BESIDES.items() if fbx.of_kind(kind)]
        animations = len(takes_of(fbx))
        return (*named, *([f"{animations} animations"] if animations > 1 else []))


def _posed(
    models: Models, joints: list[int], moving: set[int], used: _Channels, clock: Clock, name: str
) -> Motion:
    """Return the motion of some joints, in centimetres on the file's axes."""
    fbx, nodes = models.fbx, [*models.tree.above(joints[0]), *joints]
    joints, ends = models.tree.without_ends(joints, moving)
    check_proportion(models.tree, len(clock.times), len(joints), fbx.size)
    placed = PlacedModels(models, used, clock)
    placed.scales.update(_scales(models.tree, placed, nodes))
    chosen, dresser = Chosen(joints, ends), partial(read_figure, models)
    motion = posed(models.tree, placed, chosen, clock.step, name, dresser)
    unit = _unit(fbx)
    motion = motion if unit == 1.0 else motion.scaled(unit)
    return replace(motion, up=min(max(fbx.settings.whole("UpAxis", 1), 0), 2))


def _bones(models: Models, character: str | None) -> set[int]:
    """Return the bones of the largest skeleton, or of the character; none where there is none."""
    bones, tree = models.bones(), models.tree
    roots = tree.roots(bones)
    if character is not None:
        called("a skeleton (--character)", list(roots), character, tree.path)
        return bones & tree.with_descendants({roots[character]})
    first = next(iter(roots.values()), -1)
    others = [name for name, root in roots.items() if not _are_one(tree, first, root)]
    if others:
        told = f"skeleton {tree.names[first]!r} is read, not {listed(list(map(repr, others)))}"
        note(tree.path, f"{told} (--character names another)")
    one = {root for name, root in roots.items() if name not in others}
    return bones & tree.with_descendants(one)


def _are_one(tree: Tree, first: int, other: int) -> bool:
    """Tell whether two roots are of one skeleton: of one armature, as Blender calls it."""
    return first == other or tree.parents[first] == tree.parents[other] >= 0


def _animation(models: Models, bones: set[int], wanted: str | None) -> _Channels:
    """Return the channels of the animation that is wanted, or the first that moves the bones."""
    takes = takes_of(models.fbx)
    if not takes:
        raise models.fbx.error("an animation", "none")
    if wanted is not None:
        names = different([take.name for take in takes])
        take = takes[called("an animation (--animation)", names, wanted, models.fbx.path)]
        return dict(take.channels())
    below = models.tree.counted(bones)
    for take in takes:
        channels = dict(take.channels())
        moved = {models.number[one] for one, _ in channels if one in models.number}
        if any(below[model] or not bones for model in moved):
            _tell_others(models.fbx, take, takes)
            return channels
    raise models.fbx.error(_MOVING, "none")


def _tell_others(fbx: Fbx, take: Take, takes: list[Take]) -> None:
    others = [repr(other.name) for other in takes if other is not take]
    if others:
        told = f"animation {take.name!r} is read, not {listed(others)}"
        note(fbx.path, f"{told} (--animation names another)")


def _clock(fbx: Fbx, channels: _Channels) -> Clock:
    curves = [curve for each in channels.values() for curve in each.curves if curve is not None]
    straight = all(curve.straight for curve in curves)
    times = [curve.times for curve in curves]
    return common_clock(times, fbx.path, straight=straight, rate=fbx.rate)


def _scales(tree: Tree, placed: PlacedModels, nodes: list[int]) -> dict[int, float]:
    shown = {}
    for node in nodes:
        rows = placed.values(node, "S")
        moved = (placed.models.objects[node].identity, "S") in placed.channels
        shown[node] = rows[1:] if moved else rows[:1]
    return even_scales(tree, shown)


def _unit(fbx: Fbx) -> float:
    """Return centimetres of the file's unit."""
    unit = fbx.settings.number("UnitScaleFactor", 1.0)
    if not _UNITS[0] <= unit <= _UNITS[1]:
        raise fbx.error("a unit (UnitScaleFactor) that leaves lengths", f"{unit:g} cm")
    return unit


def _conventions(fbx: Fbx) -> dict[str, str]:
    settings = fbx.settings
    told = {"version": f"{fbx.version / 1000:g}"}
    for name, which in (("up", "Up"), ("front", "Front")):
        axis = settings.whole(f"{which}Axis", {"Up": 1, "Front": 2}[which])
        sign = "-" if settings.whole(f"{which}AxisSign", 1) < 0 else ""
        told[name] = f"{sign}{'XYZ'[axis]}" if 0 <= axis <= 2 else "unknown"
    told["unit"] = f"{_unit(fbx):g} cm"
    rate, creator = fbx.rate, fbx.root.first("Creator")
    told |= {} if rate is None else {"rate": f"{rate:.4g} fps"}
    program = _program(fbx) or ("" if creator is None else creator.text(0, ""))
    return told | ({"program": program} if program else {})


def _program(fbx: Fbx) -> str:
    """Return the program that exported a file, where it says."""
    scene = Properties.of(fbx.root.within("FBXHeaderExtension", "SceneInfo"))
    words = [scene.text(f"Original|Application{what}") for what in ("Name", "Version")]
    return " ".join(filter(None, words))
