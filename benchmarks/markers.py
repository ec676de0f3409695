"""Skeletons solved from markers and keypoints: how well they explain the points, and the truth.

Usage: python -m benchmarks.markers --data FOLDER [--json] [--keep]

*Walks* are the gait trials among FOLDER/other/c3d and FOLDER/other/trc: recorded markers against
the markers that hang on the solved skeleton, root mean square over all frames and markers, and
whether bones have the lengths of people: thigh and shank in shares of the leg, 24.5 % and 24.6 % of
the height (Winter 2009), left against right, and how far knees and ankles are from those
that Plug-in Gait wrote into the file. *Others* are the files of other bodies: arms, wheelchairs,
clusters without names. *Made* takes are a walk whose feet stand, with markers at known places, and
as MediaPipe's 33 keypoints with 2 cm of noise: errors of joints and angles, and how far standing
toes go. Seconds are of one core, reading left out.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks._marker_takes import (
    joint_angles,
    joint_errors,
    keypoints,
    markers,
    slides,
    standing_walk,
    with_gaps,
)
from roundelay.motion.points import Points
from roundelay.solving import Solution, solve

WALKS = (
    "c3d/BTS.c3d",
    "c3d/FunctionalWalk.c3d",
    "c3d/Gait.c3d",
    "c3d/Movement_trial.c3d",
    "c3d/PiG_Motion-FlatFoot-Full.c3d",
    "c3d/PiG_Motion-FlatFoot-Hole.c3d",
    "c3d/PiG_Motion3_FF.c3d",
    "c3d/PlugInC3D.c3d",
    "c3d/Qualisys.c3d",
    "c3d/Eb015pi.c3d",
    "c3d/Dec_real.c3d",
    "trc/Gait.trc",
)
OTHERS = (
    "c3d/FP_Type1.c3d",
    "c3d/Optotrak.c3d",
    "c3d/Res16bits.c3d",
    "c3d/Vicon.c3d",
    "c3d/racing_full.c3d",
    "c3d/sample_propulsion.c3d",
    "c3d/sprintbasket.c3d",
    "c3d/walkingOptiTrack.c3d",
    "trc/Anto.trc",
    "trc/Knee.trc",
    "trc/SprintMotion.trc",
)
TARGETS = (
    Target("markers_rms_mm", "<=", 15, "worst walk: markers against those on the skeleton, mm"),
    Target("walks_solved", "==", len(WALKS), "walks with a skeleton"),
    Target("sides_percent", "<=", 5, "median walk: left against right thigh and shank, %"),
    Target("made_joint_mm", "<=", 15, "worst joint of a limb, 3 mm of noise, 20 % of gaps"),
    Target("keypoints_slide_mm", "<=", 5, "median slide of standing feet, 2 cm of noise"),
    Target("keypoints_knee_degrees", "<=", 5, "knees, 2 cm of noise"),
)
MILLIMETRES = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
LIMBS = ("UpLeg", "Leg", "Foot", "Arm", "ForeArm")


def main() -> None:
    asked = parser(__doc__, data="folder that holds other/c3d/ and other/trc/")
    arguments = asked.parse_args()
    warnings.simplefilter("ignore")
    result = measured(arguments.data)
    rows = result["walks"], result["others"], result["made"]
    report("markers", result, TARGETS, arguments, table=lines(*rows))


def measured(data: Path) -> dict[str, Any]:
    """Solve skeletons of real files below ``data/other``, and of made ones."""
    walks = [of_file(data / "other" / name) for name in WALKS]
    others = [of_file(data / "other" / name) for name in OTHERS]
    made = [of_made(*case) for case in CASES]
    return {"summary": summary(walks, made), "walks": walks, "others": others, "made": made}


def of_file(path: Path) -> dict[str, Any]:
    """Solve a file; say why not where it cannot be solved."""
    row: dict[str, Any] = {"file": path.name}
    try:
        points = rl.read_points(path)
        started = time.process_time()
        solved = solve(points)
    except rl.RoundelayError as error:
        return {**row, "refused": getattr(error, "message", str(error))}
    seconds = time.process_time() - started
    factor = MILLIMETRES.get(points.units, 1.0)
    return {
        **row,
        "frames": len(solved.motion),
        "points": len(points.names),
        "markers": len(solved.markers),
        "joints": solved.motion.skeleton.n_joints,
        "rms_mm": round(factor * solved.rms, 2),
        "worst_marker_mm": round(factor * worst(solved), 1),
        "noise_mm": round(factor * solved.noise, 3),
        **bones(solved.motion, factor),
        **beside_plug_in_gait(points, solved, factor),
        "milliseconds_a_frame": round(1000.0 * seconds / len(solved.motion), 1),
    }


def worst(solved: Solution) -> float:
    """Root mean square of the marker that fits worst."""
    return float(np.sqrt(np.nanmean(solved.residuals**2, axis=0)).max())


def bones(motion: rl.Motion, factor: float) -> dict[str, float]:
    """Lengths of thighs and shanks in mm, and the larger difference of sides in percent."""
    skeleton = motion.skeleton
    found: dict[str, float] = {}
    sides = []
    for bone, joint in (("thigh", "Leg"), ("shank", "Foot")):
        if f"Left{joint}" in skeleton.names and f"Right{joint}" in skeleton.names:
            left, right = (
                factor * float(np.linalg.norm(skeleton.offsets[skeleton.index(f"{side}{joint}")]))
                for side in ("Left", "Right")
            )
            found[f"{bone}_mm"] = round(0.5 * (left + right), 1)
            sides.append(100.0 * abs(left - right) / (0.5 * (left + right)))
    if len(found) == 2:
        found["thigh_to_shank"] = round(found["thigh_mm"] / found["shank_mm"], 3)
        found["sides_percent"] = round(max(sides), 2)
    return found


def beside_plug_in_gait(points: Points, solved: Solution, factor: float) -> dict[str, float]:
    """Median distances of knees and ankles, in mm, from those that Plug-in Gait wrote, if so."""
    found = {}
    places, names = solved.motion.positions(), solved.motion.skeleton.names
    for joint, part, origin in (("knee", "Leg", "FEO"), ("ankle", "Foot", "TIO")):
        apart = [
            np.linalg.norm(theirs - places[:, names.index(f"{side}{part}")], axis=1)
            for side in ("Left", "Right")
            if f"{side[0]}{origin}" in points.names and f"{side}{part}" in names
            for theirs in (_place(points, f"{side[0]}{origin}", solved.frames),)
        ]
        if apart:
            found[f"{joint}_beside_plug_in_gait_mm"] = round(factor * float(np.nanmedian(apart)), 1)
    return found


def _place(points: Points, name: str, frames: tuple[int, int]) -> Any:
    return points.to_array()[slice(*frames), points.names.index(name)]


# Made takes -----------------------------------------------------------------------------------

CASES: tuple[tuple[str, Callable[..., Any], float, float, float], ...] = (
    ("markers", markers, 100.0, 0.0, 0.0),
    ("markers, 1 mm of noise", markers, 100.0, 0.001, 0.0),
    ("markers, 3 mm, 20 % gaps", markers, 100.0, 0.003, 0.2),
    ("keypoints", keypoints, 30.0, 0.0, 0.0),
    ("keypoints, 1 cm", keypoints, 30.0, 0.01, 0.0),
    ("keypoints, 2 cm", keypoints, 30.0, 0.02, 0.0),
    ("keypoints, 2 cm, 20 % gaps", keypoints, 30.0, 0.02, 0.2),
)
SEEDS = 3


def of_made(
    name: str, points_of: Callable[..., Any], fps: float, noise: float, gaps: float
) -> dict[str, Any]:
    """Medians over some draws of noise and gaps."""
    rows = []
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        motion, standing = standing_walk(strides=6, fps=fps, seed=seed)
        names, places = points_of(motion)
        places = places + noise * rng.standard_normal(places.shape)
        points = Points(names, places, fps, units="m")
        solved = solve(with_gaps(points, gaps, rng) if gaps else points)
        errors = joint_errors(motion, solved)
        held = slides(solved, standing)
        rows.append(
            {
                "rms_mm": 1000.0 * solved.rms,
                "joint_mm": 1000.0
                * max(errors[f"{side}{limb}"] for side in ("Left", "Right") for limb in LIMBS),
                "hip_mm": 1000.0 * max(errors["LeftUpLeg"], errors["RightUpLeg"]),
                "slide_mm": 1000.0 * median(held),
                "longest_slide_mm": 1000.0 * max(held),
                **{
                    f"{joint}_degrees": angle
                    for joint, angle in joint_angles(motion, solved).items()
                },
            }
        )
    return {"take": name, **{key: round(median(row[key] for row in rows), 2) for key in rows[0]}}


def summary(walks: list[dict[str, Any]], made: list[dict[str, Any]]) -> dict[str, Any]:
    solved = [row for row in walks if "rms_mm" in row]
    by_name = {row["take"]: row for row in made}
    noisy = by_name["keypoints, 2 cm"]
    return {
        "walks": len(walks),
        "walks_solved": len(solved),
        "markers_rms_mm": max((row["rms_mm"] for row in solved), default=None),
        "markers_rms_mm_median": _median(solved, "rms_mm"),
        "sides_percent": _median(solved, "sides_percent"),
        "knee_beside_plug_in_gait_mm": _median(solved, "knee_beside_plug_in_gait_mm"),
        "ankle_beside_plug_in_gait_mm": _median(solved, "ankle_beside_plug_in_gait_mm"),
        "made_joint_mm": by_name["markers, 3 mm, 20 % gaps"]["joint_mm"],
        "keypoints_slide_mm": noisy["slide_mm"],
        "keypoints_knee_degrees": noisy["knee_degrees"],
        "keypoints_elbow_degrees": noisy["elbow_degrees"],
    }


def _median(rows: list[dict[str, Any]], key: str) -> float | None:
    found = [row[key] for row in rows if key in row]
    return round(median(found), 2) if found else None


def lines(*tables: list[dict[str, Any]]) -> Iterator[str]:
    for table in tables:
        for row in table:
            name, *rest = row.items()
            yield f"{name[1]:32s} " + "  ".join(f"{key} {value}" for key, value in rest)
        yield ""


if __name__ == "__main__":
    main()
