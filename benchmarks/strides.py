"""Steps and strides: moments of made walks, intervals of means, force plates, Zeni's rule anew.

Usage: python -m benchmarks.strides --data FOLDER [--json] [--keep] [--runs 2000]

Walks of `roundelay.synth.steps`, at 120 frames a second, differ in speed, stride and spread, over
ground, on a treadmill and backward, as skeletons and as markers with noise of 1 mm:
``event_frames`` is the share of moments told within a frame, ``stride_percent`` the 95th
percentile of errors of single strides, ``mean_stride_percent`` the largest error of a walk's mean
stride. ``coverage`` is the share of runs of related random stride times, 12 to 60 strides and
correlations of 0 to .5, whose interval of 95 % holds the true mean. ``plates`` is the share of
moments within 20 ms of those that force plates in the C3D trials tell, for whole feet alone on a
plate whose heel and toe are marked by name; ``plates_all`` counts all trials. On walks of ``truth``
and the C3D trials moments stand beside Zeni's rule, written here anew: how much later they are, and
which share of Zeni's steps is missed.

``modes_better``: of cycles with six repetitions or more, the share whose left-out second halves
modes predict better than the mean does; ``modes_found``: of the known ways in which repetitions of
made walks differ, the share that modes tell. ``style_nearer``: of captures whose style another
content shows, too, the share that lies nearer to that style laid on the plain cycle of its content
than to the plain cycle itself.

``tracker``: phases told frame by frame, RMS in turns over all frames, of takes by their own cycle
and by those of the person's other takes (truth: the offline phase), and of made walks; how long who
was lost takes to be found at most; processor time a frame; what is told of random motion a minute;
and the share of takes of one gait whose period is told before a fourth repetition ends.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks import _live as live
from benchmarks._harness import Target, parser, report
from benchmarks._left_out import TOLD, known_ways, left_out_repetitions, styles
from benchmarks._plates import PlateStep, plate_steps
from benchmarks._truth_data import captures
from benchmarks.start import ANKLES, HIPS
from roundelay import synth
from roundelay.gait.feet import feet_of_motion
from roundelay.gait.spread import mean_interval
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.motion.floating import motion_of_points

Array = NDArray[np.float64]

TARGETS = (
    Target("event_frames", ">=", 0.95, "share of moments within a frame at 120 fps"),
    Target("stride_percent", "<=", 1.0, "error of single strides in per cent, 95th percentile"),
    Target("mean_stride_percent", "<=", 0.2, "error of a walk's mean stride in per cent"),
    Target("coverage", ">=", 0.93, "intervals of 95 % hold the mean"),
    Target("coverage", "<=", 0.97, "intervals of 95 % hold the mean, and not too often"),
    Target("plates", ">=", 0.9, "share of moments within 20 ms of the plates'"),
    Target("tracker.same", "<=", 0.02, "phase off frame by frame, same take, RMS in turns"),
    Target("tracker.other", "<=", 0.05, "phase off frame by frame, the person's other takes"),
    Target("tracker.made_same", "<=", 0.02, "phase off frame by frame, made walks, same person"),
    Target("tracker.made_other", "<=", 0.05, "phase off frame by frame, made walks, another"),
    Target("tracker.microseconds", "<=", 50.0, "microseconds a frame"),
    Target("tracker.back", "<=", 1.0, "periods until who was lost is found"),
    Target("tracker.false_a_minute", "<=", 0.1, "periods told of random motion, a minute"),
    Target("modes_better", ">=", 0.8, "share of cycles that modes predict better than the mean"),
    Target("style_nearer", ">=", 0.75, "share of captures nearer than their plain cycle"),
)
# Made walks: speed in metres a second and stride in seconds; each in all ways.
PACES = ((0.8, 1.25), (1.1, 1.1), (1.3, 1.0))
WAYS = ({}, {"treadmill": True}, {"backward": True})
# Trials that another file holds again.
AGAIN = ("Eb015sr.c3d", "Eb015vr.c3d", "TESTAPI.c3d", "sgi_int.c3d")
MARKED = re.compile(r"^([lr])[ ._]?(hee|toe|met|mt5|fcc|fm1|fm5|foot|ft[123])", re.IGNORECASE)
# Walks of truth that are looked at, and frames of the longest.
WALKS, LONGEST = 24, 3000
# Where heel and toe markers are, from the ankle, and their noise, in metres.
HEEL, TOE, NOISE = (0.0, -0.05, -0.04), (0.0, -0.05, 0.18), 0.001
# Strides and correlations of neighbours in runs of the intervals.
COUNTS, RELATED = (12, 20, 40, 60), (0.0, 0.3, 0.5)
# Where there is no moment at all.
MISSED = 999.0


def main() -> None:
    asked = parser(__doc__, data="folder that holds truth/ and other/c3d/")
    asked.add_argument("--runs", type=int, default=2000, help="of the intervals")
    arguments = asked.parse_args()
    warnings.simplefilter("ignore", rl.RoundelayWarning)
    walks = list(_made())
    trials = list(_trials(arguments.data / "other" / "c3d"))
    beside = [*_walks(arguments.data / "truth"), *(_beside(*trial[:2]) for trial in trials)]
    beside = [row for row in beside if row is not None]
    on_plates = [row for name, motion, steps in trials for row in _on_plates(name, motion, steps)]
    covered = list(_covered(arguments.runs))
    found = {"walks": walks, "beside": beside, "plates": on_plates, "covered": covered}
    found |= {
        "modes": list(left_out_repetitions(arguments.data / "truth")),
        "ways": list(known_ways()),
        "styles": list(styles(arguments.data)),
        "tracked": list(live.tracked_takes(arguments.data)),
        "tracked_made": list(live.tracked_walks()),
        "again": list(live.found_again()),
        "told": list(live.periods_told(arguments.data / "truth")),
        "cost": [{"microseconds": live.microseconds()} | live.false_periods()],
    }
    table = [str(row) for rows in found.values() for row in rows]
    report("strides", {"summary": _summary(found), **found}, TARGETS, arguments, table=table)


def _summary(found: dict[str, list[dict[str, Any]]]) -> dict[str, Any]:
    walks, plates = found["walks"], found["plates"]
    off = [x for row in walks for x in row["off_frames"]]
    marked = [row for row in plates if row["marked"]]
    kinds = {"strike": [], "off": []}
    for row in marked:
        kinds[row["kind"]].append(row["milliseconds"])
    zeni = {kind: [row[kind] for row in found["beside"] if row[kind] is not None] for kind in kinds}
    return {
        "walks": len(walks),
        "moments": len(off),
        "event_frames": _share(abs(x) <= 1.0 for x in off),
        "stride_percent": _quantile([x for row in walks for x in row["strides_percent"]], 0.95),
        "mean_stride_percent": max(abs(row["mean_percent"]) for row in walks),
        "runs": sum(row["runs"] for row in found["covered"]),
        "coverage": round(
            sum(row["held"] for row in found["covered"])
            / sum(row["runs"] for row in found["covered"]),
            4,
        ),
        "plates": _share(abs(row["milliseconds"]) <= 20.0 for row in marked),
        "plates_n": len(marked),
        "plates_all": _share(abs(row["milliseconds"]) <= 20.0 for row in plates),
        "plates_all_n": len(plates),
        "plates_median_ms": {kind: _quantile(x, 0.5, signed=True) for kind, x in kinds.items()},
        "plates_zeni": _share(abs(row["zeni_milliseconds"]) <= 20.0 for row in marked),
        "beside": len(found["beside"]),
        "after_zeni_ms": {kind: _quantile(x, 0.5, signed=True) for kind, x in zeni.items()},
        "missed": round(
            sum(row["missed"] for row in found["beside"])
            / max(1, sum(row["steps"] for row in found["beside"])),
            4,
        ),
        **_predicted(found),
        "tracker": _tracked(found),
    }


def _tracked(found: dict[str, list[dict[str, Any]]]) -> dict[str, Any]:
    (cost,) = found["cost"]
    summary = {
        f"{name}{kind}": _pooled([row for row in found[rows] if row["kind"] == kind])
        for name, rows in (("", "tracked"), ("made_", "tracked_made"))
        for kind in ("same", "other")
    }
    return summary | {
        "takes": sum(row["kind"] == "same" for row in found["tracked"]),
        "pairs": sum(row["kind"] == "other" for row in found["tracked"]),
        "back": max(row["periods"] for row in found["again"]),
        "microseconds": cost["microseconds"],
        "false_a_minute": round(cost["told"] / cost["minutes"], 3),
        "random_minutes": cost["minutes"],
        "told_in_time": _share(
            row["after"] is not None and row["after"] <= 4 for row in found["told"]
        ),
        "told_takes": len(found["told"]),
    }


def _pooled(rows: list[dict[str, Any]]) -> float:
    """Return the RMS over all frames of several takes."""
    known = [(row["frames"], row["rms"]) for row in rows if row["rms"] is not None]
    squares = sum(count * rms**2 for count, rms in known)
    return round(float(np.sqrt(squares / sum(count for count, _ in known))), 4)


def _predicted(found: dict[str, list[dict[str, Any]]]) -> dict[str, Any]:
    errors = [row["error"] for row in found["modes"]]
    nearness = [row["nearness"] for row in found["styles"]]
    return {
        "modes_better": _share(x < 1.0 for x in errors),
        "modes_cycles": len(errors),
        "modes_error": _quantile(errors, 0.5),
        "modes_found": _share(x >= TOLD for row in found["ways"] for x in row["told"]),
        "style_nearer": _share(x < 1.0 for x in nearness),
        "style_captures": len(nearness),
        "style_nearness": _quantile(nearness, 0.5),
    }


def _share(right: Iterator[bool]) -> float | None:
    told = list(right)
    return round(float(np.mean(told)), 3) if told else None


def _quantile(values: list[float], level: float, *, signed: bool = False) -> float | None:
    used = values if signed else [abs(x) for x in values]
    return round(float(np.quantile(used, level)), 3) if used else None


# Made walks -----------------------------------------------------------------------------------


def _made() -> Iterator[dict[str, Any]]:
    for number, (speed, stride) in enumerate(PACES):
        for way in WAYS:
            made = synth.steps(8, speed=speed, stride=stride, spread=0.03, rng=number, **way)
            for marks in (False, True):
                take = _as_markers(made.motion, number) if marks else made.motion
                named = " ".join([*way, "markers" if marks else "skeleton"])
                yield {"walk": f"{speed} m/s {named}"} | _measured(made, rl.strides(take))


def _as_markers(motion: rl.Motion, seed: int) -> rl.Points:
    """Show joints as points, heels and toes beside them, with 1 mm of noise."""
    points = synth.as_points(motion)
    places, turns = forward_kinematics(motion.skeleton, motion.rotations, motion.root_path)
    names, added = [], []
    for side in ("Left", "Right"):
        ankle = motion.skeleton.index(f"{side}Foot")
        for what, offset in (("Heel", HEEL), ("Toe", TOE)):
            names.append(f"{side}{what}")
            added.append(places[:, ankle] + rot.rotate(turns[:, ankle], np.array(offset)))
    whole = np.concatenate([points.positions, np.stack(added, axis=1)], axis=1)
    whole += np.random.default_rng(seed).normal(scale=NOISE, size=whole.shape)
    return rl.Points((*points.names, *names), whole, points.fps, units="m", name=motion.name)


def _measured(made: synth.Stepped, told: rl.Strides) -> dict[str, Any]:
    off: dict[str, list[float]] = {"strike": [], "off": []}
    strides, means = [], []
    for kind, truth in (("strike", made.strikes), ("off", made.offs)):
        for foot, frames in truth.items():
            times = np.array(told.times(foot, kind)) * told.fps
            off[kind] += [_nearest(times, frame) for frame in frames]
    for foot, frames in made.strikes.items():
        true, found = np.diff(frames), told.times(foot, "strike")
        own = np.diff(found) * told.fps
        if len(own) == len(true):
            strides += (100.0 * (own / true - 1.0)).round(3).tolist()
        means.append(100.0 * (told.summary[foot]["time"].mean * told.fps / true.mean() - 1.0))
    return {
        "rule": told.rule,
        "strike_frames": round(float(np.median(off["strike"])), 2),
        "leave_frames": round(float(np.median(off["off"])), 2),
        "off_frames": [round(x, 2) for x in off["strike"] + off["off"]],
        "strides_percent": strides,
        "mean_percent": round(float(max(means, key=abs)), 4),
    }


def _nearest(times: Array, true: float) -> float:
    """Return by how much the moment nearest to a true one is late; far off if there is none."""
    return float(times[np.argmin(abs(times - true))] - true) if len(times) else MISSED


# Intervals ------------------------------------------------------------------------------------


def _covered(runs: int) -> Iterator[dict[str, Any]]:
    """Count the runs of related stride times whose interval holds the mean they are drawn about."""
    draw, cases = np.random.default_rng(18), [(n, r) for n in COUNTS for r in RELATED]
    for count, related in cases:
        each, held = runs // len(cases) + (runs % len(cases) > 0), 0
        for _ in range(each):
            values = 1.1 + 0.02 * _drawn(draw, count, related)
            low, high = mean_interval(values, level=0.95, resamples=1000, rng=draw)
            held += low <= 1.1 <= high
        yield {"strides": count, "related": related, "runs": each, "held": held}


def _drawn(draw: np.random.Generator, count: int, related: float) -> Array:
    values = draw.normal(size=count)
    for place in range(1, count):
        values[place] = related * values[place - 1] + np.sqrt(1 - related**2) * values[place]
    return values


# Trials with plates ---------------------------------------------------------------------------


def _trials(folder: Path) -> Iterator[tuple[str, rl.Motion, list[PlateStep]]]:
    for path in sorted(folder.iterdir()):
        if path.name in AGAIN:
            continue
        try:
            points = rl.read_points(path)
            motion = motion_of_points(points)
            feet_of_motion(motion)
        except rl.RoundelayError:
            continue
        yield path.name, motion, list(plate_steps(points, _marked(points.names)))


def _marked(names: tuple[str, ...]) -> dict[str, list[str]]:
    """Return the markers of each foot by their names."""
    found: dict[str, list[str]] = {"left": [], "right": []}
    for name in names:
        if (at := MARKED.match(name)) and not name.endswith(" 2"):
            found["left" if at[1].lower() == "l" else "right"].append(name)
    return found


def _on_plates(name: str, motion: rl.Motion, steps: list[PlateStep]) -> Iterator[dict[str, Any]]:
    if not steps:
        return
    rules = {rule: _told(motion, rule) for rule in ("auto", "zeni")}
    known = {plain for one in _marked(motion.skeleton.names).values() for plain in one}
    marked = all(any(word in x.lower() for x in known) for word in ("hee", "to"))
    marked |= all(any(word in x.lower() for x in known) for word in ("hee", "met"))
    marked |= all(any(word in x.lower() for x in known) for word in ("fcc", "fm1"))
    for step in steps:
        for kind, true in (("strike", step.strike), ("off", step.off)):
            late = {
                rule: 1000.0 * _nearest(np.array(told.times(step.side, kind)), true)
                for rule, told in rules.items()
                if told is not None
            }
            yield {
                "trial": name,
                "side": step.side,
                "kind": kind,
                "marked": marked,
                "milliseconds": round(late.get("auto", 1000.0 * MISSED), 1),
                "zeni_milliseconds": round(late.get("zeni", 1000.0 * MISSED), 1),
            }


def _told(motion: rl.Motion, rule: str) -> rl.Strides | None:
    """Tell the strides of a trial, which need not repeat; None where no foot comes down."""
    options = rl.StrideOptions(rule=rule, everywhere=True, resamples=100)
    try:
        return rl.strides(motion, options)
    except rl.RoundelayError:
        return None


# Zeni's rule anew -----------------------------------------------------------------------------


def _walks(folder: Path) -> Iterator[dict[str, Any] | None]:
    gaits = [one for one in captures(folder) if one.period is not None and one.frames < LONGEST]
    for place in np.unique(np.linspace(0, len(gaits) - 1, WALKS).astype(int)):
        yield _beside(gaits[place].file, rl.read(folder / gaits[place].file))


def _beside(name: str, motion: rl.Motion) -> dict[str, Any] | None:
    """Compare moments of all frames with the places where feet turn; None without feet by name."""
    told = _told(motion, "auto")
    parts = _parts(motion)
    if told is None or parts is None:
        return None
    late: dict[str, list[float]] = {"strike": [], "off": []}
    missed = steps = 0
    for side, (heel, toe, pelvis) in parts.items():
        for kind, sign, end in (("strike", 1.0, heel), ("off", -1.0, toe)):
            times = np.array(told.times(side, kind))
            for frame in _zeni(end, pelvis, motion, sign):
                steps, away = steps + 1, _nearest(times, frame / motion.fps)
                missed += abs(away) > 0.2
                late[kind] += [1000.0 * away] if abs(away) <= 0.2 else []
    medians = {k: round(float(np.median(x)), 1) if x else None for k, x in late.items()}
    return {"take": name, "rule": told.rule, "steps": steps, "missed": missed, **medians}


def _parts(motion: rl.Motion) -> dict[str, tuple[Array, Array, Array]] | None:
    """Return heel, toe and pelvis of both feet by names of joints alone."""
    names, places = [x.lower() for x in motion.skeleton.names], motion.positions()
    hips = next((names.index(one) for one in HIPS if one in names), 0)
    found = {}
    for side in ("left", "right"):
        letter = {"left": "l", "right": "r"}[side]
        wanted = [_sided(one, letter, side) for one in ANKLES] + [f"{letter}hee", f"{letter} heel"]
        heel = next((names.index(one) for one in reversed(wanted) if one in names), None)
        if heel is None:
            return None
        ends = (f"{letter}toe", f"{letter} met", f"{side}toebase", f"{letter}toes")
        toe = next((names.index(one) for one in ends if one in names), heel)
        found[side] = (places[:, heel], places[:, toe], places[:, hips])
    return found


def _sided(ankle: str, letter: str, side: str) -> str:
    """Return the name of an ankle of the left as that of a side."""
    if "left" in ankle:
        return ankle.replace("left", side)
    return re.sub(r"^l|(?<=_)l$", letter, ankle)


def _zeni(end: Array, pelvis: Array, motion: rl.Motion, sign: float) -> list[int]:
    """Return the frames at which a foot is farthest ahead of the pelvis, or behind it."""
    level, reach = 1.0 - motion.up_vector, round(0.5 * motion.fps)
    frames = np.arange(len(end))
    later, earlier = np.minimum(frames + reach, frames[-1]), np.maximum(frames - reach, 0)
    way = (pelvis[later] - pelvis[earlier]) * level
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    ahead = sign * np.sum((end - pelvis) * way, axis=1)
    near, middle = round(0.3 * motion.fps), 0.5 * (ahead.min() + ahead.max())
    return [
        frame
        for frame in range(near, len(ahead) - near)
        if ahead[frame] > max(middle, ahead[frame - 1])
        and ahead[frame] == ahead[frame - near : frame + near + 1].max()
    ]


if __name__ == "__main__":
    main()
