"""Limbs that pass through each other in loops, blends and transitions, before and after repair.

Usage: python -m benchmarks.limbs --data FOLDER [--pairs 200] [--json] [--keep]

Of all captures (BVH, AMC) below the folder: how many loops, blends of two cycles of one skeleton
(at random weights) and transitions have bones that meet, meet more than in the captures they are
made from, and still do so after `roundelay.cycles.edit.separate`; by how many degrees a joint was
turned; and of what was repaired the change of velocity across the seam, mean jerk and skate of a
period, before and after, in body sizes and seconds (medians).
"""

from __future__ import annotations

import time
import warnings
from collections import defaultdict
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from roundelay.cycles.edit.separate import Mended, repaired, repaired_motion, source_parts
from roundelay.geometry.contacts import find_feet, foot_points, skate
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.separation import deepest
from roundelay.loops.quality import jerk, velocity_changes
from roundelay.motion.features import point_cloud

Found = tuple[rl.Cycle, list[rl.Motion]]
FPS = 120.0
TARGETS = (
    Target("loops.left", "<=", 0, "loops in which limbs still meet after repair"),
    Target("blends.left", "<=", 0, "blends in which they do"),
)


def main() -> None:
    options = parser(__doc__, data="folder of captures")
    options.add_argument("--pairs", type=int, default=200, help="pairs of cycles a skeleton")
    arguments = options.parse_args()
    warnings.simplefilter("ignore")
    found = cycles(arguments.data)
    pairs = alike(found, arguments.pairs)
    rng = np.random.default_rng(1)
    blends, transitions = [], []
    for (first, ours), (second, theirs) in pairs:
        share = rng.uniform(0.2, 0.8)
        try:
            blends.append((rl.blend([first, second], [share, 1.0 - share]), ours + theirs))
            transitions.append((rl.transition(first, second), ours + theirs))
        except ValueError:
            # A joint turns all the way round in one of them only.
            continue
    result = {
        "loops": summary([looped(*one) for one in found]),
        "blends": summary([looped(*one) for one in blends]),
        "transitions": summary([passed(*one) for one in transitions]),
    }
    report("limbs", {"summary": result}, TARGETS, arguments)


def cycles(folder: Path) -> list[Found]:
    """The cycles of all captures that have some, with the parts that show them."""
    found = []
    for path in sorted([*folder.rglob("*.bvh"), *folder.rglob("*.amc")]):
        try:
            motion = rl.read(path)
            found += [(cycle, source_parts(cycle, motion)) for cycle in rl.find_cycles(motion)]
        except rl.RoundelayError:
            continue
    return found


def alike(found: list[Found], most: int) -> list[tuple[Found, Found]]:
    """Pairs of cycles of one skeleton, at most so many of each."""
    groups, rng, pairs = defaultdict(list), np.random.default_rng(0), []
    for one in found:
        groups[one[0].skeleton.names, one[0].skeleton.parents].append(one)
    for group in groups.values():
        all_pairs = list(combinations(group, 2))
        pairs += [all_pairs[i] for i in rng.permutation(len(all_pairs))[:most]]
    return pairs


def looped(cycle: rl.Cycle, sources: list[rl.Motion]) -> dict[str, Any]:
    started = time.perf_counter()
    after, mended = repaired(cycle, sources)
    seconds = time.perf_counter() - started
    row = _row(cycle.sample(), after.sample(), mended, sources) | {"seconds": seconds}
    return row | ({"figures": [_figures(cycle), _figures(after)]} if mended else {})


def passed(motion: rl.Motion, sources: list[rl.Motion]) -> dict[str, Any]:
    started = time.perf_counter()
    after, mended = repaired_motion(motion, sources)
    seconds = time.perf_counter() - started
    return _row(motion, after, mended, sources) | {"seconds": seconds}


def _row(
    before: rl.Motion, after: rl.Motion, mended: tuple[Mended, ...], sources: list[rl.Motion]
) -> dict[str, Any]:
    allowed: dict[tuple[str, str], float] = {}
    met = _deepest(before)
    for source in sources if met else []:
        for pair, depth in _deepest(source).items():
            allowed[pair] = max(depth, allowed.get(pair, 0.0))
    over, left = (
        any(depth > allowed.get(pair, 0.0) for pair, depth in part.items())
        for part in (met, _deepest(after))
    )
    degrees = max((float(np.degrees(one.angle)) for one in mended), default=0.0)
    return {"meet": bool(met), "over": over, "left": left, "degrees": degrees}


def _deepest(motion: rl.Motion) -> dict[tuple[str, str], float]:
    return deepest(motion.skeleton, motion.rotations, motion.translations)


def _figures(cycle: rl.Cycle) -> list[float]:
    points = point_cloud(cycle.sample(FPS))
    seam = velocity_changes(np.concatenate([points[-2:], points[:2]]), FPS).max()
    rough = jerk(np.concatenate([points, points[:6]]), FPS).reshape(len(points), -1, 3)
    loop = cycle.sample(FPS, periods=2, repeat_first=True)
    placed = forward_kinematics(
        loop.skeleton, loop.rotations, loop.root_path, translations=loop.translations
    )
    feet = find_feet(loop.skeleton, placed[0], loop.up)
    slid = 0.0
    if feet:
        size = loop.skeleton.size
        slid = 0.5 * skate(foot_points(feet, *placed), fps=FPS, size=size, up=loop.up)
    return [float(seam), float(np.linalg.norm(rough, axis=-1).mean()), slid]


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    turned = [row for row in rows if row["degrees"] > 0.0]
    degrees = [row["degrees"] for row in turned] or [0.0]
    idle = [row["seconds"] for row in rows if not row["meet"]] or [0.0]
    busy = [row["seconds"] for row in turned] or [0.0]
    told: dict[str, Any] = {
        "count": len(rows),
        **{key: sum(row[key] for row in rows) for key in ("meet", "over", "left")},
        "repaired": len(turned),
        "degrees": {"median": round(float(np.median(degrees)), 2), "most": round(max(degrees), 2)},
        "seconds_idle": round(float(np.median(idle)), 4),
        "seconds_repairing": round(float(np.median(busy)), 4),
    }
    figures = np.array([row["figures"] for row in turned if "figures" in row])
    if len(figures):
        before, after = np.median(figures, axis=0)
        for number, name in enumerate(("seam_velocity", "jerk", "skate")):
            told[name] = {
                "before": round(float(before[number]), 5),
                "after": round(float(after[number]), 5),
            }
    return told


if __name__ == "__main__":
    main()
