"""What [A] says of its captures of several motions, and its blends, beside what is found here.

Usage: python -m benchmarks.paper_a --data FOLDER [--json] [--keep]

- ``rows``: captures of table 1 and figures 7, 9, 10, 11: bars, classes, excitation regions, and
  the parts found by `find_cycles`, with the times of [A] (its cohomology alone) beside ours (all
  of it). A behaviour that [A] tells of counts as found if some class
  makes .8 turns in its frames, with half of the variation of its regions there.
- ``concatenations``: three captures end to end, 20 times by a seeded choice. A part is back if its
  ends are within .5 s and its period within 5 % of what is found in its capture alone.
- ``blends``: a walk and a run at 11 weights; a transition between them.
- ``trajectories``: the typical trajectory of [A] 4.4 (centroids), [C]'s regression, the default,
  from the same frames: template error, jerk over the capture's ([A] 6.3), seam, frames a second.
- ``throughput``: poses a second of `CycleSpace.rotations`, by CPU time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks.paper_a_data import FRAMES_A_SECOND, KINDS, ROWS, Row, excerpt
from benchmarks.raunio import find_capture
from roundelay.cycles.models import cycle_models
from roundelay.geometry import contacts
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.loops.quality import quality
from roundelay.motion.features import point_cloud
from roundelay.timeline.proposals.excitation import Excitation, excitations

Result = TypeVar("Result")
METRICS = ("euclidean", "variance", "adjacent")
MOST_CLASSES = 8
TARGETS = (
    Target("parts", "==", 60, "parts of 20 concatenations"),
    Target("back", ">=", 57, "parts found again within .5 s, their periods within 5 %"),
    Target("blends.period", "==", 1, "the period of a blend grows with its weight"),
    Target("blends.speed", "==", 1, "so does its speed"),
    Target("blends.skate_of_travel", "==", 1, "and its sliding over the distance"),
    Target("trajectories.walk.harmonic.frames_a_second", ">=", 1000, "frames a second, to cycle"),
)


def timed(work: Callable[[], Result], repeats: int = 3) -> tuple[Result, float, float]:
    """Return a result with the least CPU and wall seconds it took."""
    spent = []
    for _ in range(repeats):
        cpu, wall = time.process_time(), time.perf_counter()
        result = work()
        spent.append((time.process_time() - cpu, time.perf_counter() - wall))
    return result, min(c for c, _ in spent), min(w for _, w in spent)


def row(data: Path, name: str, paper: Row) -> dict[str, Any]:
    motion = find_capture(data, name)[slice(*paper.frames)]
    found: dict[str, Any] = {"capture": name, "frames": len(motion), "[A]": paper.figures()}
    for metric in METRICS:
        found[metric] = _classes(motion, metric, paper)
    found["parts"], cpu, wall = timed(lambda: parts_of(motion))
    found["parts_seconds"] = {"cpu": round(cpu, 3), "wall": round(wall, 3)}
    return found


def _classes(motion: rl.Motion, metric: Any, paper: Row) -> dict[str, Any]:
    def work() -> Any:
        cloud = point_cloud(motion.with_root_motion())
        return excitations(cloud, motion.fps, metric=metric)

    found, cpu, wall = timed(work)
    bars = np.column_stack([found.barcode.births, found.barcode.deaths])[:10]
    return {
        "seconds": {"cpu": round(cpu, 3), "wall": round(wall, 3)},
        "longest_bars": bars.round(3).tolist(),
        "n_classes": len(found.classes),
        "classes": [_class(excited) for excited in found.classes[:MOST_CLASSES]],
        "behaviours": {
            name: max((_share(c, frames) for c in found.classes), default=(0.0, 0.0))
            for name, frames in paper.behaviours.items()
        },
    }


def _class(excited: Excitation) -> dict[str, Any]:
    return {
        "bar": excited.coordinate.class_index,
        "birth": round(excited.coordinate.birth, 3),
        "death": round(excited.coordinate.death, 3),
        "scale": round(excited.coordinate.scale, 3),
        "p": float(f"{excited.p_value:.1g}"),
        "regions": [[r.start, r.stop, round(r.net, 2)] for r in excited.regions],
    }


def _share(excited: Excitation, frames: tuple[tuple[int, int], ...]) -> tuple[float, float]:
    """Turns of a class within some frames, and the share of its regions' variation there."""
    moved = np.abs(np.diff(excited.turns, prepend=excited.turns[0]))
    active, inside = (np.zeros(len(moved), bool) for _ in range(2))
    for region in excited.regions:
        active[region.start : region.stop] = True
    for start, stop in frames:
        inside[start:stop] = True
    here, everywhere = float(moved[active & inside].sum()), float(moved[active].sum())
    share = here / max(everywhere, 1e-12)
    return (round(here, 2) if share >= 0.5 else 0.0, round(share, 2))


def parts_of(
    motion: rl.Motion, proposers: tuple[str, ...] | None = None
) -> list[dict[str, Any]] | str:
    try:
        cycles = rl.find_cycles(motion)
    except rl.NoPeriod as refusal:
        return str(refusal)
    return [
        {
            "frames": [list(run) for run in cycle.evidence.runs],
            "period": round(cycle.period * motion.fps, 1),
            "confidence": round(cycle.evidence.confidence or 0.0, 2),
        }
        for cycle in cycles
        if cycle.evidence is not None
    ]


def concatenation(data: Path, rng: np.random.Generator) -> dict[str, Any]:
    kinds = rng.choice(list(KINDS), 3, replace=False)
    chosen = [KINDS[kind][rng.integers(len(KINDS[kind]))] for kind in kinds]
    motions = [excerpt(data, name, frames) for name, frames in chosen]
    first = motions[0]
    whole = rl.concatenate(
        [rl.Motion(first.skeleton, m.rotations, m.root_path, first.frame_time) for m in motions]
    )
    found, cpu, _ = timed(lambda: parts_of(whole), 1)
    places = np.cumsum([0, *map(len, motions)])
    parts = [
        _back(motion, name, int(place), found)
        for motion, (name, _), place in zip(motions, chosen, places[:-1], strict=True)
    ]
    return {"parts": parts, "found": found, "cpu_seconds": round(cpu, 3)}


def _back(motion: rl.Motion, name: str, place: int, found: Any) -> dict[str, Any]:
    alone = parts_of(motion)[0]
    start, stop = place + alone["frames"][0][0], place + alone["frames"][-1][1]
    near = 0.5 * motion.fps
    back = not isinstance(found, str) and any(
        abs(a - start) <= near
        and abs(b - stop) <= near
        and abs(other["period"] / alone["period"] - 1.0) <= 0.05
        for other in found
        for a, b in other["frames"]
    )
    return {"capture": name, "frames": [start, stop], "period": alone["period"], "back": back}


def blends(data: Path) -> dict[str, Any]:
    motions = [find_capture(data, name) for name in ("07_01", "09_01")]
    walk, run = cycles = [rl.find_cycles(motion)[0] for motion in motions]
    limits = [quality(*pair).capture_velocity for pair in zip(cycles, motions, strict=True)]
    space = rl.CycleSpace.of(cycles)
    rows = [_blend(space.cycle([1.0 - w, w]), float(w)) for w in np.linspace(0.0, 1.0, 11)]
    figures = ("period", "speed", "skate", "skate_of_travel")
    return {
        "rows": rows,
        "monotone": {key: _monotone([one[key] for one in rows]) for key in figures},
        "seam_velocity_limits": [round(limit, 4) for limit in limits],
        "transition": {
            "largest_step": _smoothness(rl.transition(walk, run, 0.6)),
            "walk_alone": _smoothness(walk.sample(periods=3, foot_lock=False)),
            "run_alone": _smoothness(run.sample(periods=3, foot_lock=False)),
        },
    }


def _blend(cycle: rl.Cycle, weight: float) -> dict[str, float]:
    loop, size = cycle.sample(periods=2, foot_lock=False), cycle.skeleton.size
    steps = np.degrees(rot.angle_between(loop.rotations[1:, 1:], loop.rotations[:-1, 1:]))
    largest, seam = steps.max(axis=1), len(loop) // 2 - 1
    bends = np.diff(point_cloud(loop)[seam - 1 : seam + 3], 2, axis=0).reshape(2, -1, 3)
    change = np.sqrt(np.mean(np.sum(bends**2, axis=-1), axis=-1)) * loop.fps
    stride = float(np.linalg.norm(cycle.travel)) / size
    skate = _skate(cycle, locked=False)
    return {
        "weight": round(weight, 1),
        "period": round(cycle.period, 4),
        "speed": round(stride / cycle.period, 4),
        "skate": round(skate, 4),
        "skate_of_travel": round(skate / stride, 4),
        "skate_locked": round(_skate(cycle, locked=True), 4),
        "seam_degrees": round(float(largest[seam]), 3),
        "step_degrees": round(float(np.delete(largest, seam).max()), 3),
        "seam_velocity": round(float(change.max()), 4),
    }


def _skate(cycle: rl.Cycle, *, locked: bool) -> float:
    """Sliding of the feet in sizes a period."""
    loop = cycle.sample(periods=3, foot_lock=locked)
    places, turns = forward_kinematics(loop.skeleton, loop.rotations, loop.root_path)
    feet = contacts.find_feet(loop.skeleton, places, loop.up)
    points = contacts.foot_points(feet, places, turns)
    size = loop.skeleton.size
    return contacts.skate(points, fps=loop.fps, size=size, up=loop.up) / 3.0


def _smoothness(motion: rl.Motion) -> dict[str, float]:
    """Largest changes from frame to frame, of anything, of velocity, of the root's path."""
    size, fps = motion.skeleton.size, motion.fps
    places, path = motion.positions() / size, motion.root_path / size
    return {
        "pose_step": round(float(np.linalg.norm(np.diff(places, axis=0), axis=-1).max()), 5),
        "velocity_step": round(
            float(np.linalg.norm(np.diff(places, 2, axis=0), axis=-1).max() * fps), 4
        ),
        "root_velocity_step": round(
            float(np.linalg.norm(np.diff(path, 2, axis=0), axis=-1).max() * fps), 4
        ),
    }


def _monotone(values: list[float]) -> bool:
    steps = np.diff(values)
    return bool(np.all(steps >= 0.0) or np.all(steps <= 0.0))


def trajectories(data: Path) -> list[dict[str, Any]]:
    rows = []
    for kind, chosen in KINDS.items():
        name, frames = chosen[0]
        motion = excerpt(data, name, frames)
        for method in cycle_models.names():
            options = rl.Options(method=method, most=1)
            found, cpu, _ = timed(lambda options=options, m=motion: rl.find_cycles(m, options))
            figures = quality(found[0], motion)
            rows.append(
                {
                    "kind": kind,
                    "capture": name,
                    "method": method,
                    "template_error": round(figures.template_error, 3),
                    "jerk_of_capture": round(figures.loop_jerk / figures.capture_jerk, 3),
                    "seam_velocity": round(figures.seam_velocity, 3),
                    "frames_a_second": round(len(motion) / cpu),
                }
            )
    return rows


def throughput(data: Path) -> dict[str, Any]:
    cycles = [rl.find_cycles(find_capture(data, name))[0] for name in ("07_01", "09_01")]
    space, rng = rl.CycleSpace.of(cycles), np.random.default_rng(0)
    rates = {}
    for count in (1, 10, 100, 1000):
        phase, weights = rng.random(count), rng.dirichlet([1.0, 1.0], count)
        calls = 2000 // count

        def work(phase: Any = phase, weights: Any = weights, calls: int = calls) -> None:
            for _ in range(calls):
                space.rotations(weights, phase)

        rates[f"{count} a call"] = round(calls * count / timed(work, 7)[1])
    return {"joints": cycles[0].skeleton.n_joints, "poses_a_second": rates}


def main() -> None:
    arguments = parser(__doc__).parse_args()
    rng = np.random.default_rng(0)
    joined = [concatenation(arguments.data, rng) for _ in range(20)]
    back = [part["back"] for one in joined for part in one["parts"]]
    result = {
        "rows": [row(arguments.data, name, paper) for name, paper in ROWS.items()],
        "concatenations": {"parts": len(back), "back": sum(back), "rows": joined},
        "blends": blends(arguments.data),
        "trajectories": trajectories(arguments.data),
        "throughput": throughput(arguments.data),
    }
    told = {"summary": _summary(result), **result}
    report("paper_a", told, TARGETS, arguments, table=_table(result), bulk=("rows",))


def _summary(result: dict[str, Any]) -> dict[str, Any]:
    """What is stated elsewhere: parts, CPU seconds, blends, trajectories by kind and method."""
    joined, mixed = result["concatenations"], result["blends"]
    trajectories: dict[str, dict[str, Any]] = {}
    for one in result["trajectories"]:
        trajectories.setdefault(one["kind"], {})[one["method"]] = one
    return {
        "parts": joined["parts"],
        "back": joined["back"],
        "seconds": {
            one["capture"]: {
                "frames": one["frames"],
                "published": one["[A]"]["seconds"],
                "excitations": one["euclidean"]["seconds"]["cpu"],
                "find_cycles": one["parts_seconds"]["cpu"],
            }
            for one in result["rows"]
        },
        "blends": {
            **mixed["monotone"],
            "count": len(mixed["rows"]),
            **{key: _range(mixed["rows"], key) for key in ("skate", "skate_locked")},
        },
        "published_frames_a_second": FRAMES_A_SECOND,
        "trajectories": trajectories,
    }


def _range(rows: list[dict[str, Any]], key: str) -> list[float]:
    return [min(row[key] for row in rows), max(row[key] for row in rows)]


def _table(result: dict[str, Any]) -> Iterator[str]:
    for one in result["rows"]:
        yield f"{one['capture']}: {one['frames']} frames; [A] {one['[A]']['seconds']} s"
        for metric in METRICS:
            found = one[metric]
            told = ", ".join(f"{name} {turns}" for name, (turns, _) in found["behaviours"].items())
            yield f"  {metric}: {found['n_classes']} classes in {found['seconds']['cpu']} s; {told}"
        yield f"  parts in {one['parts_seconds']['cpu']} s: {one['parts']}"
    joined, mixed = result["concatenations"], result["blends"]
    yield f"concatenations: {joined['back']} of {joined['parts']} parts back"
    yield from map(str, mixed["rows"])
    yield from (f"monotone: {mixed['monotone']}", f"transition: {mixed['transition']}")
    yield from map(str, result["trajectories"])
    yield f"throughput: {result['throughput']}"


if __name__ == "__main__":
    main()
