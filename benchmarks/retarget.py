"""Retargeting: how alike motions are on other bodies, and which skeletons are understood.

Usage: python -m benchmarks.retarget --data FOLDER [--json] [--keep] [--captures 3] [--all]
       [--picture FILE [--walk CAPTURE]]

One way, from captures of FOLDER/truth to characters. ``twins`` are characters made to the names,
bones, axes, units and poses at rest of six programs, but of the proportions of who was captured:
there wrists, ankles and head are where they were, or the retargeting is wrong. ``others`` are
bodies of other proportions: the six as they are, Mixamo's Beta, and skeletons of LAFAN1, CMU and
Bandai-Namco; what their wrists lie apart in leg lengths is also what their arms and trunks are
longer or shorter. `benchmarks._carried` tells what is measured. The rival in the same run copies
the rotations of mapped joints from rest to rest, as constraints in an animation program do, with
the way of the hips scaled.

``mapped``: the share of all skeletons of FOLDER whose canonical body is found without help, and is
right by a list made by hand. ``--all`` carries the beginning of every capture of FOLDER/truth to
four characters. ``--picture FILE`` draws a walk of `roundelay.synth`, or of the capture that
``--walk`` names, on four characters.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._carried import compared, shown
from benchmarks._characters import STYLES, Places, character
from benchmarks._harness import Target, parser, report
from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.retargeting.anatomy import Anatomy
from roundelay.retargeting.onto import Retargeting
from roundelay.retargeting.reference import Reference, reference_of

Array = NDArray[np.float64]

TARGETS = (
    Target("pairs", ">=", 8, "pairs of skeletons, one way"),
    Target("limb_ends", "<=", 0.03, "wrists, ankles, head against the hips, RMS in leg lengths"),
    Target("angles", "<=", 5.0, "knees and elbows, RMS in degrees"),
    Target("facing", "<=", 2.0, "facing, largest in degrees"),
    Target("contacts_kept", ">=", 0.95, "share of contacts kept"),
    Target("slip", "<=", 0.5, "centimetres more that a standing foot strays"),
    Target("depth", "<=", 1.0, "centimetres more below the ground"),
    Target("flips", "==", 0, "frames in which a joint flips"),
    Target("mapped", ">=", 0.95, "share of skeletons mapped without help"),
)
SOURCES = ("cmu", "lafan1", "bandai1", "bandai2", "snu", "hdm05")
# Frames of a capture, from a hundred on where it has so many.
FRAMES, LEAD = 300, 100
FOUR = ("mixamo", "unreal", "vrm", "rigify")
OTHERS = {
    "Beta": "other/mixamo/Beta.bvh",
    "LAFAN1": "other/lafan1/walk4_subject1.bvh",
    "CMU": "bundle/01_01.bvh",
    "Bandai-Namco": "other/bandai_namco/dataset-1_walk_normal_001.bvh",
}
# By hand: head, left hand, left foot, left knee, right upper arm.
RIGHT = (
    ("Head", "LeftHand", "LeftFoot", "LeftLeg", "RightArm"),
    ("Head", "LeftWrist", "LeftAnkle", "LeftKnee", "RightShoulder"),
    ("head", "lHand", "lFoot", "lShin", "rShldr"),
    ("Head", "Hand_L", "Foot_L", "LowerLeg_L", "UpperArm_R"),
    ("head", "lwrist", "lfoot", "ltibia", "rhumerus"),
    ("head", "lhand", "lfoot", "ltibia", "rhumerus"),
    ("Head", "Hand_L", "Foot_L", "LoLeg_L", "UpArm_R"),
    ("Beta:Head", "Beta:LeftHand", "Beta:LeftFoot", "Beta:LeftLeg", "Beta:RightArm"),
    ("HEAD", "LEFT_HAND", "LEFT_FOOT", "LEFT_KNEE", "RIGHT_SHOULDER#"),
)
TOLD = ("head", "left hand", "left foot", "left lower leg", "right upper arm")


def main() -> None:
    arguments = parser(__doc__, data="folder that holds truth/")
    arguments.add_argument("--captures", type=int, default=3, help="captures of each source")
    arguments.add_argument("--all", action="store_true", help="all captures onto four characters")
    arguments.add_argument("--picture", type=Path, help="draw a walk on four characters")
    arguments.add_argument("--walk", type=Path, help="the walk that is drawn")
    asked = arguments.parse_args()
    if asked.picture is not None:
        _draw(asked.picture, asked.walk)
        return
    warnings.simplefilter("ignore")
    rows = [row for source in SOURCES for row in _of_source(asked.data, source, asked.captures)]
    mapped, skeletons = _mapped(asked.data)
    twins = [row for row in rows if row["kind"] == "twin"]
    summary: dict[str, Any] = {
        "pairs": len({(row["source"], row["target"], row["kind"]) for row in rows}),
        "limb_ends": _rms(twins, "limb_ends"),
        "limb_ends_others": _rms([r for r in rows if r["kind"] == "other"], "limb_ends"),
        "limb_ends_own": _rms(rows, "limb_ends_own"),
        "angles": _rms(rows, "angles"),
        "facing": max(row["facing"] for row in rows),
        "contacts_kept": _kept(rows),
        "slip": max(row["slip"] for row in rows),
        "depth": max(row["depth"] for row in rows),
        "flips": sum(row["flips"] for row in rows),
        "backward": sum(row["backward"] for row in rows),
        "copied": _copied(rows),
        "mapped": mapped,
    }
    if asked.all:
        summary["all"] = _all_onto_four(asked.data)
    summary = {key: _rounded(value) for key, value in summary.items()}
    table = [_line(row) for row in rows]
    result = {"summary": summary, "rows": rows, "skeletons": skeletons}
    report("retarget", result, TARGETS, asked, table=table, bulk=("rows",))


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return round(value, 4) if isinstance(value, float) else value


def _line(row: dict[str, Any]) -> str:
    numbers = ("limb_ends", "limb_ends_own", "angles", "facing", "slip", "depth")
    told = ", ".join(f"{name} {row[name]:.3f}" for name in numbers)
    where = f"{row['source']:8s} {row['kind']:5s} {row['target']:12s}"
    return f"{where} {row['capture'][:34]:34s} kept {row['kept']}/{row['contacts']}, {told}"


def _rms(rows: list[dict[str, Any]], name: str) -> float:
    return float(np.sqrt(np.mean([row[name] ** 2 for row in rows])))


def _kept(rows: list[dict[str, Any]]) -> float:
    return sum(row["kept"] for row in rows) / max(1, sum(row["contacts"] for row in rows))


def _copied(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Sum up what copying rotations gives on the same."""
    copied = [row["copied"] for row in rows]
    twins = [row["copied"] for row in rows if row["kind"] == "twin"]
    return {
        "limb_ends": _rms(twins, "limb_ends"),
        "limb_ends_own": _rms(copied, "limb_ends_own"),
        "angles": _rms(copied, "angles"),
        "contacts_kept": _kept(copied),
        "slip": max(row["slip"] for row in copied),
        "depth": max(row["depth"] for row in copied),
    }


def _captures(data: Path, source: str) -> list[Path]:
    folder = data / "truth" / source
    return sorted([*folder.rglob("*.bvh"), *folder.rglob("*.amc")])


def _of_source(data: Path, source: str, count: int) -> Iterator[dict[str, Any]]:
    paths = _captures(data, source)
    places = np.unique(np.linspace(0, len(paths) - 1, count).astype(int))
    others = {name: rl.read(data / path)[:600] for name, path in OTHERS.items()}
    for path in (paths[place] for place in places):
        motion = _begun(rl.read(path))
        at = _body_of(motion)
        for style in STYLES:
            for kind, body in (("twin", at), ("other", None)):
                made = character(style, meshes=False, at=body)
                yield {"source": source, "target": style, "kind": kind, "capture": path.name,
                       **_row(motion, made)}  # fmt: skip
        for name, other in others.items():
            yield {"source": source, "target": name, "kind": "other", "capture": path.name,
                   **_row(motion, other)}  # fmt: skip


def _begun(motion: rl.Motion) -> rl.Motion:
    start = LEAD if len(motion) > 2 * LEAD else 0
    return motion[start : start + FRAMES]


def _row(motion: rl.Motion, made: rl.Motion) -> dict[str, Any]:
    carrying = Retargeting.between(motion, made)
    source = shown(motion, carrying.source, carrying.learned)
    ours, copied = carrying(motion), _copy(motion, made, carrying)
    found = [compared(source, shown(m, carrying.target, carrying.own)) for m in (ours, copied)]
    return found[0] | {"copied": found[1]}


def _copy(motion: rl.Motion, made: rl.Motion, carrying: Retargeting) -> rl.Motion:
    """Return what copying rotations gives: each mapped joint turns from its rest as the other."""
    source, target = carrying.source, carrying.target
    axes = rot.multiply(rot.conjugate(rot.axis_to_y(carrying.up)), rot.axis_to_y(motion.up))
    places, turns = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    rests = []
    for skeleton in (source.skeleton, target.skeleton):
        pose = rot.identity(skeleton.n_joints) if skeleton.rest is None else skeleton.rest
        rests.append(forward_kinematics(skeleton, pose[None])[1][0])
    local = np.tile(target.skeleton.rest if target.skeleton.rest is not None
                    else rot.identity(target.skeleton.n_joints), (len(motion), 1, 1))  # fmt: skip
    pairs = {target.at[name]: source.at[name] for name in target.at if name in source.at}
    whole = np.empty_like(local)
    for joint, parent in enumerate(target.skeleton.parents):
        above = rot.identity(len(motion)) if parent < 0 else whole[:, parent]
        if joint in pairs:
            other = pairs[joint]
            turned = rot.multiply(turns[:, other], rot.conjugate(rests[0][other]))
            turned = rot.multiply(rot.multiply(axes, turned), rot.conjugate(axes))
            local[:, joint] = rot.multiply(
                rot.conjugate(above), rot.multiply(turned, rests[1][joint])
            )
        whole[:, joint] = rot.multiply(above, local[:, joint])
    scale = target.leg_length / source.leg_length
    hips = scale * rot.rotate(axes, places[:, list(source.hips)].mean(axis=1))
    still = forward_kinematics(target.skeleton, local)[0][:, list(target.hips)].mean(axis=1)
    return rl.Motion(target.skeleton, local, hips - still, motion.frame_time, up=carrying.up)


def _body_of(motion: rl.Motion) -> Places:
    """Return where a body of the proportions of who was captured has its joints, in a T-pose."""
    anatomy = Anatomy(motion.skeleton, rl.map_body(motion))
    reference = reference_of(anatomy, motion)
    scale = 0.9 / anatomy.leg_length
    places = scale * _neutral(anatomy, reference)
    top = anatomy.spine[-1] if anatomy.spine else anatomy.carrier
    at: Places = {"hips": places[anatomy.carrier], "spine0": places[top]}
    at["head"] = places[anatomy.neck[-1]]
    at["neck0"] = at["spine0"] + 0.5 * (at["head"] - at["spine0"])
    offsets = scale * np.linalg.norm(motion.skeleton.offsets, axis=1)
    for limb, stand in zip(anatomy.limbs, (None, 0, None, 1), strict=True):
        side, kind = limb.name.split()
        sign = 1.0 if side == "left" else -1.0
        end = limb.lower[-1] if limb.end is None else limb.end
        upper = float(sum(offsets[j] for j in (*limb.upper[1:], limb.lower[0])))
        lower = float(sum(offsets[j] for j in (*limb.lower[1:], end)))
        way = np.array([0.0, -1.0, 0.0] if kind == "leg" else [sign, 0.0, 0.0])
        start, last = places[limb.upper[0]], "foot" if kind == "leg" else "hand"
        for name, along in ((f"upper {kind}", 0), (f"lower {kind}", upper), (last, upper + lower)):
            at[f"{side} {name}"] = start + along * way
        if stand is None:
            girdle = places[limb.upper[0] if limb.girdle is None else limb.girdle]
            apart = np.linalg.norm(start - girdle) > 0.02
            at[f"{side} shoulder"] = girdle if apart else start - 0.1 * way
            at[f"{side} fingers"] = at[f"{side} hand"] + 0.15 * way
        else:
            own = reference.stands[stand]
            bone = motion.skeleton.offsets[own.joint] if limb.tip is not None else own.offset
            down = scale * (own.ankle - own.ball)
            level = np.sqrt(max((scale * np.linalg.norm(bone)) ** 2 - down**2, 0.01))
            at[f"{side} toes"] = at[f"{side} foot"] + np.array([0.0, -down, level])
    lowest = min(place[1] for place in at.values())
    return {name: place - (0.0, lowest, 0.0) for name, place in at.items()}


def _neutral(anatomy: Anatomy, reference: Reference) -> Array:
    """Return places (J, 3) of a body whose trunk is straight and faces Z."""
    skeleton = anatomy.skeleton
    places = np.zeros((skeleton.n_joints, 3))
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            turn = rot.conjugate(reference.frames.get(parent, rot.identity()))
            places[joint] = places[parent] + rot.rotate(turn, skeleton.offsets[joint])
    return places


def _mapped(data: Path) -> tuple[float, list[dict[str, Any]]]:
    """Return the share of skeletons that are mapped right, and each of them."""
    rows: dict[tuple[str, ...], dict[str, Any]] = {}
    for path in sorted(data.rglob("*")):
        if path.suffix.lower() in (".bvh", ".amc", ".fbx", ".glb", ".gltf", ".vrm"):
            try:
                motion = rl.read(path)
            except (rl.RoundelayError, ValueError, OSError):
                continue
            names = motion.skeleton.names
            if names in rows:
                rows[names]["files"] += 1
            else:
                told = f"{path.parent.name}/{path.name}"
                rows[names] = {"file": told, "files": 1} | _understood(motion)
    bodies = [row for row in rows.values() if row["body"]]
    return sum(row["right"] for row in bodies) / max(1, len(bodies)), list(rows.values())


def _understood(motion: rl.Motion) -> dict[str, Any]:
    names = set(motion.skeleton.names)
    wanted = next((each for each in RIGHT if names.issuperset(each)), None)
    try:
        joints = rl.map_body(motion).joints
    except rl.RoundelayError as error:
        return {"body": wanted is not None, "right": False, "told": str(error)[:120]}
    right = wanted is not None and tuple(joints.get(name) for name in TOLD) == wanted
    return {"body": True, "right": right, "told": f"{len(joints)} joints"}


def _all_onto_four(data: Path) -> dict[str, Any]:
    """Carry every capture of truth/ to four characters; animals to animals."""
    made = [character(name, meshes=False) for name in FOUR]
    count, failed = 0, []
    paths = sorted((data / "truth").rglob("*"))
    for path in (path for path in paths if path.suffix in (".bvh", ".amc")):
        motion = rl.read(path)
        motion = motion[: min(len(motion), FRAMES)]
        animal = rl.map_body(motion).kind == "quadruped"
        onto = [motion, replace(motion, name="twin")] if animal else made
        for one in onto:
            count += 1
            try:
                again = rl.retarget(motion, one)
                if not np.isfinite(again.positions()).all():
                    failed.append(f"{path.name} onto {one.name}: not finite")
            except Exception as error:  # whatever fails is told
                failed.append(f"{path.name} onto {one.name}: {error}")
    return {"carried": count, "failed": len(failed), "failures": failed[:20]}


def _draw(path: Path, walk: Path | None) -> None:
    """Draw eight poses of a period on four characters, one below the other."""
    from matplotlib import pyplot

    made = synth.gait("walk", repetitions=6).motion if walk is None else rl.read(walk)
    cycle = rl.find_cycles(made)[0]
    figure, rows = pyplot.subplots(len(FOUR), 1, figsize=(11, 11))
    for axes, name in zip(rows, FOUR, strict=True):
        body = character(name)
        loop = rl.retarget(cycle, body).sample()
        frames = np.arange(8) * len(loop) // 8
        places, turns = forward_kinematics(loop.skeleton, loop.rotations, loop.root_path)
        to_y, level = rot.axis_to_y(loop.up), 1.0 - loop.up_vector
        x, _, z = rot.rotate(to_y, loop.root_path[-1] - loop.root_path[0])
        ahead = rot.from_rotation_vector(np.array([0.0, -np.arctan2(x, z), 0.0]))
        turn = rot.multiply(ahead, to_y)
        assert loop.skeleton.figure is not None
        for number, frame in enumerate(frames):
            axes_of = rot.to_matrix(turns[frame])
            for mesh in loop.skeleton.figure.meshes:
                spots = mesh.posed(places[frame], axes_of, loop.skeleton.names)
                spots = rot.rotate(turn, spots - loop.root_path[frame] * level)
                _paint(axes, spots / loop.skeleton.size, mesh.faces, 0.42 * number)
        axes.axhline(0.0, color="0.6", lw=0.8, zorder=0)
        axes.set(aspect="equal", xlim=(-0.3, 3.25), ylim=(-0.03, 0.8), title=name)
        axes.axis("off")
    figure.tight_layout()
    figure.savefig(path, dpi=80)


def _paint(axes: Any, spots: Array, faces: Array, along: float) -> None:
    """Paint triangles as seen from the side, the nearer ones over the others."""
    from matplotlib.collections import PolyCollection

    corners = spots[faces]
    order = np.argsort(corners[..., 0].mean(axis=1))[::-1]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    light = 0.55 + 0.4 * np.abs(across @ (0.6, 0.7, 0.4)) / np.maximum(
        np.linalg.norm(across, axis=1), 1e-12
    )
    colours = np.clip(light[:, None] * np.array([0.55, 0.68, 0.82]), 0.0, 1.0)
    flat = np.stack([corners[..., 2] + along, corners[..., 1]], axis=-1)
    axes.add_collection(PolyCollection(flat[order], facecolors=colours[order], edgecolors="none"))


if __name__ == "__main__":
    main()
