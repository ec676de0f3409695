"""Tables A.1-A.3 and B.1-B.3 of [C], row by row: published, our faithful models, our default.

    python -m benchmarks.harmonic --data FOLDER [--json] [--keep] [--rows 07_01 ...] [--no-paper]

Template matching ([C] eq. 4.4, 4.5) over all frames (table C.1 for boxing), the same metric for
the faithful models and for the default:

- *channels*: distance of the file's own rotation channels, the root's included, in radians and
  unwrapped (see `euler_angles`); of equivalent triples of the loop the one nearest to the
  capture's. The root's translation is out, and the steady turning of the default's root too: it
  lies in the travel. For the faithful models also *plain*: without equivalent triples, as
  published.
- *rotation*: root of the sum of squared angles of rotation of all joints but the root.
- *own*: rotation over the frames the cycle was found in. A capture that turns or stops half-way
  is no repeated stride as a whole.

The loop of the default is its frames (a whole number a period, repeated) before the foot lock,
which is measured beside it. The default searches whole captures, boxing too, where *own* is its
figure. The method "paper" fits [C]'s models to the frames and the coordinate that the default
found, with and without velocities and accelerations. Poses put before a capture (a T-pose, or
frames before a jump of a limb in the first few) are left out for all.
`benchmarks.harmonic_pictures` draws the rows where [C] fails.
"""

from __future__ import annotations

import time
import timeit
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay
from benchmarks._harness import Target, parser, report
from benchmarks.harmonic_metrics import composed, errors
from benchmarks.raunio_tables import PUBLISHED, SCALE, Published
from roundelay.cycles.models import constrained
from roundelay.cycles.models.regression import fit_cycle
from roundelay.cycles.models.weighted import paper_cycle
from roundelay.geometry import rotations as rot
from roundelay.loops.quality import quality, velocity_changes
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.phase.tempo import time_phase
from roundelay.reproduction import raunio
from roundelay.reproduction.configuration import euler_angles
from roundelay.timeline.evidence import measure as measure_behaviour
from roundelay.timeline.search import Search

Array = NDArray[np.float64]

# Whose methods some functions run, which no user's path does.
LABELLED = {"faithful": "[C] M1, M2, M3"}

# What the method "paper" is constrained by ([C] 5.3 items 20, 21).
CONSTRAINTS: dict[str, dict[str, bool]] = {
    "velocity, acceleration": {},
    "velocity": {"acceleration": False},
    "acceleration": {"velocity": False},
    "neither": {"velocity": False, "acceleration": False},
}

TARGETS = (
    Target("walk.channels", "<=", 0.282, "walks: median template error of [C], rad"),
    Target("run.channels", "<=", 0.251, "runs: median template error of [C], rad"),
    Target("channels_to_published.below", ">=", 56, "rows below the published M1 of 61"),
    Target("own_to_published.below", ">=", 61, "rows below it, over the frames found periodic"),
    Target("seam_velocity <= capture_velocity", ">=", 61, "seams no rougher than the capture"),
    Target("loop_jerk <= capture_jerk", ">=", 61, "loops of no more jerk than the capture"),
    Target("loop_skate <= capture_skate", ">=", 61, "loops that slide no more than the capture"),
)


@dataclass(frozen=True)
class Row:
    """What was measured of one capture."""

    published: Published
    frames: int
    faithful: dict[str, dict[str, Any]]
    default: dict[str, Any]
    method_paper: dict[str, dict[str, Any]]


def captures(data: Path) -> dict[str, Path]:
    """Find the captures of the tables: AMC where there is one, else BVH."""
    found = {}
    for row in PUBLISHED:
        amc = data / "cmu" / "acclaim" / row.trial[:2] / f"{row.trial}.amc"
        bvh = data / "cmu" / "bvh" / f"{row.trial}.bvh"
        if amc.exists() or bvh.exists():
            found[row.trial] = amc if amc.exists() else bvh
    return found


def load(path: Path, frames: tuple[int, int] | None) -> Motion:
    """Read a capture, without other poses put before it."""
    motion = roundelay.read(path)
    motion = motion[1:] if path.suffix == ".bvh" else motion
    if frames is not None:
        return motion[frames[0] : frames[1]]
    turned = rot.angle_between(motion.rotations[1:7], motion.rotations[:6])
    jumps = np.flatnonzero(np.sum(turned > np.radians(30.0), axis=1) > 3)
    return motion[int(jumps[-1]) + 1 :] if len(jumps) else motion


def faithful(motion: Motion, row: Published) -> dict[str, dict[str, Any]]:
    """Run M1, M2 and M3 with the settings of the tables."""
    angles = euler_angles(motion, motion.rotations)
    results = {}
    for name, model in (("M1", constrained.M1), ("M2", constrained.M2), ("M3", constrained.M3)):
        options = raunio.PaperOptions(model=model, scale=SCALE[row.kind])
        try:
            found = raunio.with_primes(angles.reshape(len(motion), -1), options)
        except roundelay.RoundelayError as error:
            results[name] = {"failed": str(error)}
            continue
        loop = found.sample().reshape(-1, *angles.shape[1:])
        turned = composed(motion, loop)
        results[name] = {
            **errors(motion, turned),
            "plain": raunio.template_error(angles.reshape(len(motion), -1), found.sample())[0],
            "rmse": found.errors,
            "periods": found.period_count,
        }
    return results


def default(motion: Motion) -> dict[str, Any]:
    """Run the default and measure its first cycle."""
    begun = time.perf_counter()
    try:
        cycle = roundelay.find_cycles(motion)[0]
    except roundelay.RoundelayError as error:
        return {"failed": str(error)}
    seconds = time.perf_counter() - begun
    figures = quality(cycle, motion)
    loop = cycle.sample(in_place=True, foot_lock=False).rotations
    locked = cycle.sample(in_place=True).rotations
    return {
        **errors(motion, loop),
        "own": figures.template_error,
        "locked": errors(motion, locked)["channels"],
        "periods": figures.repetitions,
        "period": cycle.period * motion.fps,
        "frames_used": figures.frames,
        "seconds": seconds,
        "quality": asdict(figures),
    }


def method_paper(motion: Motion) -> dict[str, dict[str, Any]]:
    """Run the method "paper" on the first cycle's frames with each set of constraints."""
    try:
        cycle = roundelay.find_cycles(motion)[0]
    except roundelay.RoundelayError as error:
        return {name: {"failed": str(error)} for name in CONSTRAINTS}
    return {
        name: asdict(quality(paper_cycle(cycle, motion, **used), motion))
        for name, used in CONSTRAINTS.items()
    }


def measure(data: Path, only: Sequence[str], *, with_paper: bool) -> list[Row]:
    """Measure every capture of the tables that is there."""
    rows = []
    for row in PUBLISHED:
        path = captures(data).get(row.trial)
        if path is None or (only and row.trial not in only):
            continue
        motion = load(path, row.frames)
        old = faithful(motion, row) if with_paper else {}
        # The windows of table C.1 hold about one punch: two are needed to know the period.
        whole = motion if row.frames is None else load(path, None)
        fitted = method_paper(whole) if with_paper else {}
        rows.append(Row(row, len(motion), old, default(whole), fitted))
    return rows


def stages(motion: Motion) -> dict[str, float]:
    """Return the best of 5 times of each stage of `find_cycles`, in milliseconds."""
    search = Search.of_take(motion, roundelay.Options())
    points = search.points
    found = roundelay.find_periodic(motion)[0]
    phase = time_phase(points, found.turns, found.runs, frame_time=motion.frame_time)
    cycle = fit_cycle(motion, phase, found.runs)
    work = {
        "poses": lambda: Search.of_take(motion, roundelay.Options()),
        "timeline": lambda: roundelay.understand(motion),
        "topology": lambda: measure_behaviour(search, found.behaviour),
        "time": lambda: time_phase(points, found.turns, found.runs, frame_time=motion.frame_time),
        "fit": lambda: fit_cycle(motion, phase, found.runs),
        "find_cycles, all": lambda: roundelay.find_cycles(motion),
        "sample": lambda: cycle.sample(),
    }
    return {name: 1e3 * min(timeit.repeat(job, number=1, repeat=5)) for name, job in work.items()}


def hand_made(data: Path) -> list[dict[str, Any]]:
    """Measure loops closed by hand as they are: seam, skate and jerk a period."""
    rows = []
    for path in sorted((data / "other" / "hand_made_loops").glob("*.bvh")):
        motion = roundelay.read(path)
        cycle = roundelay.find_cycles(motion)[0]
        places = point_cloud(motion)
        around = np.concatenate([places[-2:], places[:2]])
        steps = np.degrees(
            rot.angle_between(motion.rotations, np.roll(motion.rotations, 1, axis=0))
        )[:, 1:].max(axis=1)
        figures = asdict(quality(cycle, motion))
        figures["hand_seam_rotation"] = float(steps[0])
        figures["hand_seam_velocity"] = float(velocity_changes(around, motion.fps).max())
        rows.append({"loop": path.stem, "frames": len(motion), **figures})
    return rows


def summary(rows: list[Row]) -> dict[str, Any]:
    """Count what the project promises on walks and runs."""
    result: dict[str, Any] = {}
    for kind in SCALE:
        chosen = [row for row in rows if row.published.kind == kind]
        result[kind] = {
            "rows": len(chosen),
            "published_m1": _median([row.published.template[0] for row in chosen]),
            **{f"m1_{key}": _median([row.faithful.get("M1", {}).get(key) for row in chosen])
               for key in ("plain", "channels")},
            **{key: _median([row.default.get(key) for row in chosen])
               for key in ("channels", "rotation", "own", "locked")},
        }  # fmt: skip
    gaits = [row for row in rows if row.published.kind != "boxing"]
    for key in ("channels", "rotation", "own"):
        ratio = {
            row.published.trial: row.default.get(key, np.inf) / row.published.template[0]
            for row in gaits
        }
        worst = sorted(ratio.items(), key=lambda item: -item[1])[:6]
        result[f"{key}_to_published"] = {
            "below": sum(value < 1.0 for value in ratio.values()),
            "above_1.2": sum(value > 1.2 for value in ratio.values()),
            "worst": {name: round(float(value), 2) for name, value in worst},
        }
    figures = [row.default["quality"] for row in gaits if "quality" in row.default]
    for ours, theirs in (
        ("seam_velocity", "capture_velocity"),
        ("loop_jerk", "capture_jerk"),
        ("loop_skate", "capture_skate"),
    ):
        result[f"{ours} <= {theirs}"] = sum(f[ours] <= f[theirs] for f in figures)
    result["methods"] = methods(gaits)
    frames = sum(row.frames for row in gaits)
    seconds = sum(row.default.get("seconds", 0.0) for row in gaits)
    result["frames_a_second"] = frames / max(seconds, 1e-9)
    return result


def methods(rows: list[Row]) -> dict[str, Any]:
    """Return medians of the default and of the method "paper" by its constraints."""
    measured = {"default": [row.default.get("quality", {}) for row in rows]}
    for name in CONSTRAINTS:
        measured[f"paper: {name}"] = [row.method_paper.get(name, {}) for row in rows]
    shown = ("template_error", "velocity_error", "seam_velocity", "seam_rotation", "loop_jerk")
    return {
        name: {key: _median([one.get(key) for one in found]) for key in shown}
        for name, found in measured.items()
    }


def _median(values: list[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return round(float(np.median(known)), 3) if known else None


def main() -> None:
    options = parser(__doc__)
    options.add_argument("--rows", nargs="*", default=[])
    options.add_argument("--no-paper", action="store_true")
    arguments = options.parse_args()
    rows = measure(arguments.data, arguments.rows, with_paper=not arguments.no_paper)
    result = {
        "summary": summary(rows),
        "stages_ms_500_frames": stages(load(captures(arguments.data)["12_03"], (0, 500))),
        "hand_made": hand_made(arguments.data),
        "rows": [asdict(row) for row in rows],
    }
    report("harmonic", result, TARGETS, arguments, table=lines(rows), bulk=("rows",))


def lines(rows: list[Row]) -> Iterator[str]:
    yield "               published M1      | faithful: M1 M2 M3 plain, channels; RMSE h h' h''"
    yield "                                 | default: channels rotation own locked"
    for row in rows:
        p, d = row.published, row.default
        old = [row.faithful.get(model, {}) for model in ("M1", "M2", "M3")]
        errors_ = [model.get(key, np.nan) for key in ("plain", "channels") for model in old]
        own = [d.get(key, np.nan) for key in ("channels", "rotation", "own", "locked")]
        words = (
            f"{p.kind:6} {p.trial} {row.frames:4d} {p.template[0]:.2f} n {p.periods:.2f}",
            "rmse", *p.m1_rmse, "|", *(f"{value:.2f}" for value in errors_),
            f"n {old[0].get('periods', np.nan):.2f}",
            "rmse", *(f"{value:.2f}" for value in old[0].get("rmse", ())), "|",
            *(f"{value:.2f}" for value in own), f"n {d.get('periods', np.nan):.2f}",
            f"T {d.get('period', np.nan):.1f}", d.get("failed", "")[:60],
        )  # fmt: skip
        yield " ".join(map(str, words))


if __name__ == "__main__":
    main()
