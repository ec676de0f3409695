"""Characters made to the names, bones, axes, units and poses at rest of well-known programs.

Their proportions are those of Mixamo's and Unreal's mannequins, of Rigify's human metarig, of a
character of VRoid, and of an average man; each is a pose at rest with boxes for limbs as meshes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from roundelay.geometry import rotations as rot
from roundelay.geometry.figure import Figure, Material, Mesh
from roundelay.geometry.kinematics import forward_kinematics

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Build:
    """Lengths of a body in metres, and how its arms are held at rest."""

    hips: float
    wide: float
    thigh: float
    shank: float
    foot: float
    spine: tuple[float, ...]
    neck: tuple[float, ...]
    head: float
    collar: float
    shoulder: float
    upper: float
    fore: float
    hand: float
    # Degrees below the level, and forward at the elbow.
    lowered: float = 0.0
    bent: float = 0.0


MAN = Build(
    0.96, 0.09, 0.43, 0.42, 0.15, (0.11, 0.14, 0.13), (0.14,), 0.1, 0.02, 0.16, 0.3, 0.26, 0.18
)
BETA = Build(
    0.945, 0.095, 0.416, 0.393, 0.122, (0.093, 0.163, 0.134), (0.139,), 0.085, 0.061, 0.122,
    0.279, 0.279, 0.1,
)  # fmt: skip
MANNEQUIN = Build(
    0.9675, 0.09, 0.4257, 0.402, 0.165, (0.065, 0.065, 0.08, 0.09, 0.12), (0.12, 0.06), 0.06, 0.038,
    0.158, 0.303, 0.27, 0.15, 48.0, 12.0,
)  # fmt: skip
VROID = Build(
    0.88, 0.075, 0.385, 0.42, 0.12, (0.06, 0.12, 0.11), (0.12,), 0.075, 0.025, 0.085, 0.21, 0.215,
    0.12,
)  # fmt: skip


def placed(build: Build) -> dict[str, Array]:
    """Return places of the joints of a body: Y up, Z ahead, X left, on the ground."""
    up, left = np.eye(3)[1], np.eye(3)[0]
    at = {"hips": build.hips * up}
    place = at["hips"]
    for number, step in enumerate(build.spine):
        place = place + step * up
        at[f"spine{number}"] = place
    chest, place = place, place + build.neck[0] * up
    at["neck0"] = place
    for number, step in enumerate(build.neck[1:], 1):
        place = place + step * up
        at[f"neck{number}"] = place
    at["head"] = place + build.head * up
    at["top"] = at["head"] + 0.2 * up
    for side, sign in (("left", 1.0), ("right", -1.0)):
        down, turn = np.radians(build.lowered), np.radians(build.bent)
        way = np.array([sign * np.cos(down), -np.sin(down), 0.0])
        bent = np.cos(turn) * way + np.array([0.0, 0.0, np.sin(turn)])
        at[f"{side} shoulder"] = chest + 0.75 * build.neck[0] * up + sign * build.collar * left
        at[f"{side} upper arm"] = at[f"{side} shoulder"] + sign * build.shoulder * left
        at[f"{side} lower arm"] = at[f"{side} upper arm"] + build.upper * way
        at[f"{side} hand"] = at[f"{side} lower arm"] + build.fore * bent
        at[f"{side} fingers"] = at[f"{side} hand"] + build.hand * bent
        hip = at["hips"] + sign * build.wide * left - 0.02 * up
        at[f"{side} upper leg"] = hip
        at[f"{side} lower leg"] = hip - build.thigh * up
        at[f"{side} foot"] = hip - (build.thigh + build.shank) * up
        ankle = at[f"{side} foot"][1]
        at[f"{side} toes"] = at[f"{side} foot"] + build.foot * 0.8 * np.eye(3)[2] - 0.8 * ankle * up
        at[f"{side} tip"] = at[f"{side} toes"] + 0.07 * np.eye(3)[2] - 0.1 * ankle * up
    return at


Places = dict[str, Array]
Rows = list[tuple[str, str | None, Array]]
_ARM = ("shoulder", "upper arm", "lower arm", "hand")
_LEG = ("upper leg", "lower leg", "foot", "toes")


def _chain(at: Places, part: str) -> list[str]:
    return sorted(name for name in at if name.startswith(part))


def _rows(
    at: Places, middle: dict[str, str], limb: Callable[[str, str], str], root: str | None = None
) -> Rows:
    """Return name, parent and place of every joint, by what a program calls them."""
    rows: Rows = [] if root is None else [(root, None, np.zeros(3))]
    above, chest = root, ""
    for part in ["hips", *_chain(at, "spine"), *_chain(at, "neck"), "head"]:
        rows.append((middle[part], above, at[part]))
        above = middle[part]
        chest = above if part.startswith("spine") else chest
    for side in ("left", "right"):
        for top, parts in ((chest, _ARM), (middle["hips"], _LEG)):
            names = [limb(side, part) for part in parts]
            places = [at[f"{side} {part}"] for part in parts]
            rows += zip(names, [top, *names[:-1]], places, strict=True)
    return rows


def _middle(at: Places, hips: str, spine: list[str], neck: list[str], head: str) -> dict[str, str]:
    parts = ["hips", *_chain(at, "spine"), *_chain(at, "neck"), "head"]
    return dict(zip(parts, [hips, *spine, *neck, head], strict=True))


def _mixamo(at: Places) -> Rows:
    parts = ("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase")
    names = dict(zip(_ARM + _LEG, parts, strict=True))
    middle = _middle(at, "Hips", ["Spine", "Spine1", "Spine2"], ["Neck"], "Head")
    rows = _rows(
        at,
        {key: f"mixamorig:{name}" for key, name in middle.items()},
        lambda side, part: f"mixamorig:{side.title()}{names[part]}",
    )
    return rows + _fingers(at, "mixamorig:{Side}Hand", "mixamorig:{Side}Hand{finger}{n}")


def _fingers(at: Places, hand: str, form: str) -> Rows:
    more: Rows = []
    for side in ("left", "right"):
        words = {"Side": side.title(), "S": side[0].upper()}
        way = at[f"{side} fingers"] - at[f"{side} hand"]
        for finger, off in (("Index", 0.025), ("Middle", 0.0), ("Little", -0.04)):
            parent = hand.format(**words)
            for n in (1, 2):
                name = form.format(finger=finger, n=n, **words)
                place = at[f"{side} hand"] + (0.45 + 0.25 * n) * way + np.array([0.0, 0.0, off])
                more.append((name, parent, place))
                parent = name
    return more


def _unreal(at: Places) -> Rows:
    parts = ("clavicle", "upperarm", "lowerarm", "hand", "thigh", "calf", "foot", "ball")
    names = dict(zip(_ARM + _LEG, parts, strict=True))
    spine = [f"spine_{k:02d}" for k in range(1, 6)]
    middle = _middle(at, "pelvis", spine, ["neck_01", "neck_02"], "head")
    rows = _rows(at, middle, lambda side, part: f"{names[part]}_{side[0]}", "root")
    for side in ("left", "right"):
        for bone, to in (("upper arm", "lower arm"), ("lower arm", "hand"),
                         ("upper leg", "lower leg")):  # fmt: skip
            start, stop, name = at[f"{side} {bone}"], at[f"{side} {to}"], names[bone]
            for number, share in ((1, 0.33), (2, 0.66)):
                place = start + share * (stop - start)
                rows.append((f"{name}_twist_{number:02d}_{side[0]}", f"{name}_{side[0]}", place))
    rows.append(("ik_foot_root", "root", np.zeros(3)))
    rows += [(f"ik_foot_{s[0]}", "ik_foot_root", at[f"{s} foot"]) for s in ("left", "right")]
    return rows


def _unity(at: Places) -> Rows:
    middle = _middle(at, "Hips", ["Spine", "Chest", "UpperChest"], ["Neck"], "Head")
    rows = _rows(at, middle, lambda side, part: side.title() + part.title().replace(" ", ""))
    rows += [
        (f"{side}Eye", "Head", at["head"] + (x, 0.08, 0.08))
        for side, x in (("Left", 0.03), ("Right", -0.03))
    ]
    return [*rows, ("Jaw", "Head", at["head"] + (0.0, 0.0, 0.06))]


def _vrm(at: Places) -> Rows:
    middle = _middle(at, "C_Hips", ["C_Spine", "C_Chest", "C_UpperChest"], ["C_Neck"], "C_Head")
    toes = {"toes": "ToeBase"}
    rows = _rows(
        at,
        {key: f"J_Bip_{name}" for key, name in middle.items()},
        lambda s, part: f"J_Bip_{s[0].upper()}_{toes.get(part, part.title().replace(' ', ''))}",
    )
    for number in range(3):
        above = f"J_Sec_Hair{number}_01" if number else "J_Bip_C_Head"
        place = at["head"] + (0.0, 0.1 - 0.1 * number, -0.1)
        rows.append((f"J_Sec_Hair{number + 1}_01", above, place))
    return rows + _fingers(at, "J_Bip_{S}_Hand", "J_Bip_{S}_{finger}{n}")


def _rigify(at: Places) -> Rows:
    """Return deform bones, two to a long bone in line."""
    parts = ("shoulder", "upper_arm", "forearm", "hand", "thigh", "shin", "foot", "toe")
    names = dict(zip(_ARM + _LEG, parts, strict=True))
    spine = [f"DEF-spine.{k:03d}" for k in range(1, 7)]
    middle = _middle(at, "DEF-spine", spine[:3], spine[3:5], spine[5])
    rows = _rows(at, middle, lambda side, part: f"DEF-{names[part]}.{side[0].upper()}")
    for side in ("left", "right"):
        for bone, to in (("upper arm", "lower arm"), ("lower arm", "hand"),
                         ("upper leg", "lower leg"), ("lower leg", "foot")):  # fmt: skip
            upper, lower = (f"DEF-{names[x]}.{side[0].upper()}" for x in (bone, to))
            half = 0.5 * (at[f"{side} {bone}"] + at[f"{side} {to}"])
            rows = [(n, f"{upper}.001" if n == lower else p, place) for n, p, place in rows]
            rows.append((f"{upper}.001", upper, half))
    return rows


def _smpl(at: Places) -> Rows:
    parts = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "foot")
    names = dict(zip(_ARM + _LEG, parts, strict=True))
    middle = _middle(at, "pelvis", ["spine1", "spine2", "spine3"], ["neck"], "head")
    return _rows(at, middle, lambda side, part: f"{side}_{names[part]}")


def _metarig() -> Places:
    """Return where Rigify's human metarig has its bones, with Y up."""
    spine = [(0.0552, 1.0099), (0.0172, 1.1573), (0.0004, 1.2929), (0.0059, 1.4657),
             (0.0114, 1.6582), (-0.013, 1.7197), (-0.0247, 1.7813)]  # fmt: skip
    middle = ("hips", "spine0", "spine1", "spine2", "neck0", "neck1", "head")
    at = {name: np.array([0.0, z, -y]) for name, (y, z) in zip(middle, spine, strict=True)}
    limbs = [(0.0183, -0.0684, 1.6051), (0.1953, 0.0267, 1.5846), (0.4424, 0.0885, 1.4491),
             (0.6594, 0.0492, 1.3061), (0.098, 0.0124, 1.072), (0.098, -0.0286, 0.5372),
             (0.098, 0.0162, 0.0852), (0.098, -0.0934, 0.0167)]  # fmt: skip
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for part, (x, y, z) in zip(_ARM + _LEG, limbs, strict=True):
            at[f"{side} {part}"] = np.array([sign * x, z, -y])
    return at


@dataclass(frozen=True)
class _Style:
    """How a program lays out a character, and where the one made here has its joints."""

    rows: Callable[[Places], Rows]
    axes: str
    unit: float
    up: int
    places: Callable[[], Places]


STYLES = {
    "mixamo": _Style(_mixamo, "y", 100.0, 1, lambda: placed(BETA)),
    "unreal": _Style(_unreal, "x", 100.0, 2, lambda: placed(MANNEQUIN)),
    "unity": _Style(_unity, "odd", 1.0, 1, lambda: placed(MAN)),
    "vrm": _Style(_vrm, "world", 1.0, 1, lambda: placed(VROID)),
    "rigify": _Style(_rigify, "y", 1.0, 2, _metarig),
    "smpl": _Style(_smpl, "world", 1.0, 1, lambda: placed(MAN)),
}


def character(name: str, *, meshes: bool = True, at: Places | None = None) -> rl.Motion:
    """Return a character at rest, as `roundelay.read_character` gives it.

    Its joints are at the places of a body, by what `placed` calls them; at its own by default.
    """
    style = STYLES[name]
    own = style.places()
    rows = _sorted(style.rows(own if at is None else _divided(at, own)))
    names = tuple(row[0] for row in rows)
    parents = tuple(-1 if row[1] is None else names.index(row[1]) for row in rows)
    to_up = rot.conjugate(rot.axis_to_y(style.up))
    places = rot.rotate(to_up, style.unit * np.array([row[2] for row in rows]))
    turns = _axes(places, parents, names, style.axes, to_up)
    return at_rest(names, parents, places, turns, name, style.up, meshes=meshes)


def _divided(at: Places, own: Places) -> Places:
    """Return a body whose spine and neck have as many joints as another's, evenly."""
    found = {name: place for name, place in at.items() if not name.startswith(("spine", "neck"))}
    high = at[_chain(at, "spine")[-1]]
    spine, neck = _chain(own, "spine"), _chain(own, "neck")
    for number, name in enumerate(spine, 1):
        found[name] = at["hips"] + number / len(spine) * (high - at["hips"])
    for number, name in enumerate(neck, 1):
        found[name] = high + number / (len(neck) + 1) * (at["head"] - high)
    return found


def _sorted(rows: Rows) -> Rows:
    done, found = set[str | None]({None}), []
    while len(found) < len(rows):
        for row in rows:
            if row[0] not in done and row[1] in done:
                found.append(row)
                done.add(row[0])
    return found


def at_rest(
    names: tuple[str, ...], parents: tuple[int, ...], places: Array, turns: Array, name: str,
    up: int, *, meshes: bool,
) -> rl.Motion:  # fmt: skip
    """Return a pose of joints at places (J, 3), turned (J, 4) in the world."""
    above = np.array([max(parent, 0) for parent in parents])
    back = rot.conjugate(turns[above])
    offsets = rot.rotate(back, places - places[above])
    offsets[0] = places[0]
    local = rot.multiply(back, turns)
    local[0] = turns[0]
    figure = _boxes(names, parents, places, turns) if meshes else None
    skeleton = rl.Skeleton(names, parents, offsets, (), figure=figure, rest=local)
    return rl.Motion(skeleton, local[None], places[:1], 1.0, name=name, up=up)


def _axes(
    places: Array, parents: tuple[int, ...], names: tuple[str, ...], kind: str, to_up: Array
) -> Array:
    """Return how joints are turned at rest, by a program's way of laying axes."""
    turns = np.tile(to_up if kind != "odd" else rot.identity(), (len(names), 1))
    if kind == "world":
        return turns
    rng = np.random.default_rng(5)
    for joint in range(len(names)):
        below = [k for k, parent in enumerate(parents) if parent == joint]
        if kind == "odd":
            turns[joint] = rot.normalize(rng.normal(size=4))
        elif below:
            way = places[below[0]] - places[joint]
            mirrored = kind == "x" and names[joint].endswith("_r")
            turns[joint] = _laid(-way if mirrored else way, kind, to_up)
        elif parents[joint] >= 0:
            turns[joint] = turns[parents[joint]]
    return turns


def _laid(way: Array, kind: str, to_up: Array) -> Array:
    first = way / max(np.linalg.norm(way), 1e-9)
    ahead = rot.rotate(to_up, np.array([0.0, 0.0, 1.0]))
    other = ahead if abs(first @ ahead) < 0.9 else rot.rotate(to_up, np.eye(3)[1])
    third = np.cross(first, other)
    third /= np.linalg.norm(third)
    columns = [first, np.cross(third, first), third]
    if kind == "y":
        columns = [np.cross(first, third), first, third]
    return rot.from_matrix(np.stack(columns, axis=-1))


_CUBE = np.array([[x, y, z] for x in (0, 1) for y in (-1, 1) for z in (-1, 1)], float)
_FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                   [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])  # fmt: skip


def _box(start: Array, way: Array, wide: float) -> Array:
    """Return the corners (8, 3) of a box along a bone."""
    first = way / np.linalg.norm(way)
    second = np.cross(first, np.eye(3)[int(np.argmin(np.abs(first)))])
    second /= np.linalg.norm(second)
    return start + _CUBE @ np.stack([way, wide * second, wide * np.cross(first, second)])


def _boxes(names: tuple[str, ...], parents: tuple[int, ...], places: Array, turns: Array) -> Figure:
    """Return a box for every bone, hung on the joint that carries it."""
    points, faces, moved = [], [], []
    tall = float(np.ptp(places, axis=0).max())
    for joint, parent in enumerate(parents):
        way = places[joint] - places[parent]
        # A root bone on the ground and what serves inverse kinematics are no limbs.
        if parent >= 0 and names[parent] != "root" and "ik_" not in names[joint] and np.any(way):
            faces.append(_FACES + 8 * len(points))
            points.append(_box(places[parent], way, 0.12 * np.linalg.norm(way) + 0.012 * tall))
            moved += [parent] * 8
        if names[joint].lower().endswith(("head", "spine.006")):
            faces.append(_FACES + 8 * len(points))
            points.append(_box(places[joint], 0.13 * tall * way / np.linalg.norm(way), 0.04 * tall))
            moved += [joint] * 8
    matrices = np.tile(np.eye(4), (len(names), 1, 1))
    matrices[:, :3, :3] = rot.to_matrix(turns)
    matrices[:, :3, 3] = places
    joints = np.zeros((len(moved), 4), np.int64)
    joints[:, 0] = moved
    weights = np.zeros((len(moved), 4))
    weights[:, 0] = 1.0
    mesh = Mesh("body", np.concatenate(points), np.concatenate(faces), names,
                np.linalg.inv(matrices), joints, weights, material=0)  # fmt: skip
    return Figure((mesh,), (Material("skin", (0.7, 0.5, 0.4, 1.0)),))


def rerested(motion: rl.Motion, pose: Array, names: tuple[str, ...] | None = None) -> rl.Motion:
    """Return the same motion of a skeleton that is at rest in another pose (J, 4): a known truth.

    Its joints are not turned at rest, as in a BVH, and may be called otherwise.
    """
    skeleton = motion.skeleton
    turns = forward_kinematics(skeleton, pose[None])[1][0]
    above = np.array([max(parent, 0) for parent in skeleton.parents])
    offsets = rot.rotate(turns[above], skeleton.offsets)
    offsets[0] = skeleton.offsets[0]
    ends = tuple((joint, rot.rotate(turns[joint], end)) for joint, end in skeleton.end_sites)
    whole = forward_kinematics(skeleton, motion.rotations)[1]
    whole = rot.multiply(whole, rot.conjugate(turns))
    local = whole.copy()
    local[:, 1:] = rot.multiply(rot.conjugate(whole[:, above[1:]]), whole[:, 1:])
    other = rl.Skeleton(names or skeleton.names, skeleton.parents, offsets, ends)
    return rl.Motion(
        other, local, motion.root_path, motion.frame_time, name=motion.name, up=motion.up
    )
