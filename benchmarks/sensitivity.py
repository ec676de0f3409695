"""Sensitivity: what changes if a constant that decides a result is a fifth smaller or larger.

Usage: python -m benchmarks.sensitivity --data FOLDER [--json] [--only NAME ...] [--captures 40]
       [--jobs 2] [--keep]

Every constant of `roundelay.base.thresholds.constants` is multiplied by .8 and by 1.2, one at a
time; a whole number changes by 1 at least, and a share or a cosine that would pass 1 goes half of
the way to it (a percentile to 100). Told is how many captures change in what they show (cycles
or none), in the number of cycles or segments, in the period (by more than 1 %), in another figure
(by more than 1 %; a cut by more than .25 s). Half of the captures are drawn evenly from the walks
and runs of [C], half from those in FOLDER/truth; constants of segmentation are tried on the
captures with labels, those of comparing cycles on the cycles of all captures, as a library, those
of bodies and loops on the loops of every second capture, those of points on the captures as markers
with gaps, outliers and noise, those of solving on made markers, those of variation on repetitions
drawn, those of gait on strides of captures and of made walks, those of retargeting on the
beginnings of all captures on two made characters, those of faults on all loops, clean and with the
faults of `benchmarks.check` at their least.
`--only` takes names and beginnings of names, `--keep` puts each result, as soon as it is there,
into benchmarks/results/sensitivity.json.
"""

from __future__ import annotations

import json
import math
import multiprocessing
import os
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._behaviour_takes import bandai_joins, clip_joins, hdm_joins
from benchmarks._characters import character
from benchmarks._harness import RESULTS, parser, report
from benchmarks._marker_takes import (
    bone_markers,
    joint_angles,
    keypoints,
    markers,
    standing_walk,
    with_gaps,
)
from benchmarks.check import FAULTS, METRES, Loop, in_form
from benchmarks.raunio import TABLES, find_capture
from benchmarks.segmentation_data import FULL, labelled
from roundelay import synth
from roundelay.base.thresholds import Constant, Value, constants, overridden
from roundelay.compare.packed import Packed
from roundelay.compare.spectra import Body, Spectra
from roundelay.cycles.edit.align import align
from roundelay.cycles.edit.separate import repaired, source_parts
from roundelay.cycles.events import events_of
from roundelay.geometry.kinematics import vertical_axis
from roundelay.library.groups import assigned, nearest_named
from roundelay.library.shelves import Shelf
from roundelay.loops.by_hand import CloseOptions, close_by_hand
from roundelay.loops.join import join_ratio
from roundelay.loops.lint import lint, taken_apart
from roundelay.loops.profiles import foot_contacts
from roundelay.loops.units import Lengths
from roundelay.loops.verdict import verdict_of
from roundelay.motion.features import point_cloud
from roundelay.motion.floating import motion_of_points, points_of_motion
from roundelay.motion.points import Points
from roundelay.segmentation import segment_channels
from roundelay.segmentation.gmm import GMMOptions
from roundelay.segmentation.ppca import PPCAOptions
from roundelay.solving import solve
from roundelay.timeline.options import Options
from roundelay.topology import count_classes, persistent_cohomology, turns
from roundelay.topology.toroidal import toroidal_coordinates

LABELLED = {"_topology": "roundelay.topology, as a library"}
UNDERSTANDING = tuple(
    f"timeline.{record}."
    for record in (
        "limbs",
        "predictability",
        "alignment",
        "prediction",
        "account",
        "tempo",
        "judgement",
        "closing",
    )
)
FACTORS = {"x0.8": 0.8, "x1.2": 1.2}
KINDS = ("fails", "shows", "number", "period", "figures")
LONGEST = 3000
"""Frames of the longest captures that are looked at: one constant should cost seconds."""


@dataclass(frozen=True)
class Outcome:
    """What is told of a capture."""

    number: int = 0
    """Cycles, segments or classes."""
    period: float = 0.0
    figures: tuple[float, ...] = ()
    slack: float = 1e-3
    """Figures may differ by this without being another, besides 1 %."""
    failed: str = ""

    def changed(self, other: Outcome) -> str:
        """Say what differs, the gravest; empty if nothing does."""
        if other.failed != self.failed:
            return "fails"
        if bool(other.number) != bool(self.number):
            return "shows"
        if other.number != self.number:
            return "number"
        if not math.isclose(other.period, self.period, rel_tol=0.01):
            return "period"
        if len(other.figures) != len(self.figures) or not np.allclose(
            other.figures, self.figures, rtol=0.01, atol=self.slack, equal_nan=True
        ):
            return "figures"
        return ""


def main() -> None:
    asked = parser(__doc__, data="folder that holds cmu/, truth/")
    asked.add_argument("--only", nargs="+", default=[""], help="names, or how they begin")
    asked.add_argument("--captures", type=int, default=40, help="how many are drawn")
    asked.add_argument("--jobs", type=int, default=2, help="processes")
    arguments = asked.parse_args()
    # Read by the processes that are started below, before they load NumPy.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    started = time.perf_counter()
    names = [one.name for one in constants() if one.name.startswith(tuple(arguments.only))]
    with ProcessPoolExecutor(
        arguments.jobs,
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_load,
        initargs=(arguments.data, arguments.captures),
    ) as pool:
        rows = list(pool.map(_varied, names))
    table = list(map(_line, sorted(rows, key=lambda row: -row["changed"])))
    # What is kept holds the rows of earlier runs, too.
    rows = _with_earlier(rows) if arguments.keep else rows
    seconds = round(time.perf_counter() - started, 1)
    result = {"summary": _summary(rows), "seconds": seconds, "constants": rows}
    report("sensitivity", result, (), arguments, table=table)


def _line(row: dict[str, Any]) -> str:
    said = (f"{name} {_said(row[name]):40s}" for name in FACTORS)
    return f"{row['name']:36s} {row['value']!s:>12s}  {'  '.join(said)}"


def _summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "constants": len(rows),
        "changing_nothing": sum(row["changed"] == 0 for row in rows),
        "changing_a_twentieth_at_most": sum(20 * row["changed"] <= row["captures"] for row in rows),
        "changing_most": [row["name"] for row in sorted(rows, key=lambda row: -row["changed"])[:5]],
    }


def _said(changes: dict[str, int]) -> str:
    return ", ".join(f"{kind} {count}" for kind, count in changes.items()) or "nothing"


def _with_earlier(new: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Put rows among those kept before, in the order of the constants."""
    kept = RESULTS / "sensitivity.json"
    before = json.loads(kept.read_text())["constants"] if kept.exists() else []
    rows = {row["name"]: row for row in [*before, *new]}
    return [rows[one.name] for one in constants() if one.name in rows]


# In the processes that measure --------------------------------------------------------------

_MOTIONS: list[rl.Motion] = []
_PLACE: list[Path] = []


def _load(data: Path, count: int) -> None:
    warnings.simplefilter("ignore")
    _PLACE.append(data)
    _MOTIONS.extend(_drawn(data, count))


def _drawn(data: Path, count: int) -> Iterator[rl.Motion]:
    """Read captures, half of [C]'s and half of those with truth, evenly from all there are."""
    paths = sorted(path for end in ("bvh", "amc") for path in (data / "truth").rglob(f"*.{end}"))
    truth = [path for path in paths if "single_behaviour" not in path.parts]
    for name in _evenly(list(TABLES), count // 2):
        yield find_capture(data, name)
    for path in _evenly(truth, count - count // 2):
        motion = rl.read(path)
        if len(motion) <= LONGEST:
            yield motion


def _evenly(items: list[Any], count: int) -> list[Any]:
    places = np.linspace(0, len(items) - 1, min(count, len(items))).astype(int)
    return [items[place] for place in places]


def _varied(name: str) -> dict[str, Any]:
    """Change one constant down and up; count the captures that change."""
    one = next(one for one in constants() if one.name == name)
    probe = _probe(one)
    before = _baseline(probe)
    row: dict[str, Any] = {"name": name, "value": one.value, "captures": len(before)}
    for label, factor in FACTORS.items():
        with overridden(one, varied(one, factor)):
            after = list(probe())
        told = Counter(a.changed(b) for a, b in zip(before, after, strict=True))
        row[label] = {kind: told[kind] for kind in KINDS if told[kind]}
    row["changed"] = max(sum(row[label].values()) for label in FACTORS)
    return row


def varied(one: Constant, factor: float) -> Value:
    """Return the value of a constant times a factor, as the head of this module tells."""
    if isinstance(one.value, tuple):
        return tuple(_scaled(value, factor, 1.0) for value in one.value)
    return _scaled(one.value, factor, 100.0 if "percentile" in one.unit else 1.0)


def _scaled(value: float, factor: float, limit: float) -> float:
    scaled = value * factor
    if abs(value) < limit <= abs(scaled):
        scaled = 0.5 * (value + math.copysign(limit, value))
    if isinstance(value, int):
        nearest = round(scaled)
        return max(1, max(value + 1, nearest) if factor > 1.0 else min(value - 1, nearest))
    return scaled


@cache
def _baseline(probe: Callable[[], Iterable[Outcome]]) -> list[Outcome]:
    return list(probe())


def _probe(one: Constant) -> Callable[[], Iterable[Outcome]]:
    """Return what shows the influence of a constant."""
    room, record, _ = one.name.split(".")
    rooms = {
        "compare": _library,
        "segmentation": _behaviours,
        "geometry": _loops,
        "loops": _loops,
        "solving": _solved,
        "gait": _stepped,
        "retargeting": _carried,
    }
    records = {
        "segmentation.pca": _pca,
        "segmentation.ppca": _ppca,
        "segmentation.gmm": _gmm,
        "geometry.upright": _upright,
        "loops.lint": _linted,
        "loops.gait": _linted,
        "cycles.footlock": _loops,
        "cycles.repair": _loops,
        "cycles.centroid": _centroids,
        "cycles.events": _begun,
        "cycles.take": _taken,
        "loops.by_hand": _closed,
        "phase.mixture": _centroids,
        "cycles.weighted": _weighted,
        "cycles.alignment": _aligned,
        "cycles.variation": _drawn_anew,
        "motion.frame": _pointed,
        "motion.gaps": _pointed,
        "topology.significance": _classes,
        "topology.lattice": _classes,
    }
    if one.name.startswith(UNDERSTANDING):
        return _understood
    return records.get(f"{room}.{record}") or rooms.get(room) or _found


@cache
def _takes() -> list[tuple[rl.Motion, Points]]:
    """Made walks as markers with gaps and as noisy keypoints; jumps as markers without names."""
    rng, takes = np.random.default_rng(0), []
    walk, _ = standing_walk(strides=2, fps=30)
    jumps = synth.gait("jacks", repetitions=2, fps=30).motion
    bones = ("Hips", "LeftUpLeg", "LeftLeg", "RightUpLeg")
    for motion, (names, places), noise, gaps in (
        (walk, markers(walk), 0.002, 0.15),
        (walk, keypoints(walk), 0.02, 0.0),
        (jumps, bone_markers(jumps, bones), 0.001, 0.1),
    ):
        places = places + noise * rng.standard_normal(places.shape)
        takes.append((motion, with_gaps(Points(names, places, 30.0, units="m"), gaps, rng)))
    return takes


def _solved() -> Iterator[Outcome]:
    return (_guarded(lambda m=motion, p=points: _solution(m, p)) for motion, points in _takes())


def _solution(motion: rl.Motion, points: Points) -> Outcome:
    solved = solve(points)
    angles = joint_angles(motion, solved).values()
    figures = (1000.0 * solved.rms, float(len(solved.markers)), *angles)
    return Outcome(solved.motion.skeleton.n_joints, 0.0, figures, slack=0.02)


def _guarded(work: Callable[[], Outcome]) -> Outcome:
    try:
        return work()
    except rl.RoundelayError:
        return Outcome()
    except (ValueError, IndexError, np.linalg.LinAlgError) as error:
        return Outcome(failed=type(error).__name__)


def _found() -> Iterator[Outcome]:
    return (_guarded(lambda m=motion: _cycle_of(m, Options())) for motion in _MOTIONS)


def _understood() -> Iterator[Outcome]:
    """Whole takes: of every second capture."""
    return (_guarded(lambda m=motion: _timeline_of(m)) for motion in _MOTIONS[::2])


def _timeline_of(motion: rl.Motion) -> Outcome:
    told = rl.understand(motion)
    if not told.behaviours:
        return Outcome()
    first = told.behaviours[0]
    figures = (first.probability or 0.0, first.repetitions, float(len(first.limbs)))
    return Outcome(len(told.behaviours), first.period, figures)


def _centroids() -> Iterator[Outcome]:
    options = Options(method="centroid")
    return (_guarded(lambda m=motion: _cycle_of(m, options)) for motion in _MOTIONS)


def _taken() -> Iterator[Outcome]:
    """By itself, and whether it is chosen."""
    for motion in _MOTIONS:
        yield _guarded(lambda m=motion: _cycle_of(m, Options(method="take")))
        yield _guarded(lambda m=motion: _cycle_of(m, Options()))


def _begun() -> Iterator[Outcome]:
    """At which phase the capture begins."""
    return (_guarded(lambda m=motion: _first_phase(m)) for motion in _MOTIONS)


def _first_phase(motion: rl.Motion) -> Outcome:
    first = rl.find_cycles(motion)[0]
    angle = 2 * np.pi * first.phase[first.evidence.runs[0][0]]
    figures = (float(np.cos(angle)), float(np.sin(angle)), float(len(events_of(first))))
    return Outcome(1, first.period, figures, slack=0.01)


def _stepped() -> Iterator[Outcome]:
    """Of every second capture, as it is and as markers with gaps; and of made walks."""
    for motion, timeline in _walks():
        yield _guarded(lambda m=motion, t=timeline: _strides_of(m, t))


@cache
def _stretches() -> list[rl.Motion]:
    return [motion[: min(len(motion), 240)] for motion in _MOTIONS]


def _carried() -> Iterator[Outcome]:
    """Of the beginnings of all captures on two characters."""
    for name in ("rigify", "vrm"):
        made = character(name, meshes=False)
        for motion in _stretches():
            yield _guarded(lambda m=motion, c=made: _carried_to(m, c))


def _carried_to(motion: rl.Motion, made: rl.Motion) -> Outcome:
    again = rl.retarget(motion, made)
    shown = again.at(np.linspace(0, len(again) - 1, 12))
    figures = shown.positions().reshape(-1) / made.skeleton.size
    return Outcome(1 + len(rl.map_body(motion).joints), figures=tuple(figures), slack=3e-3)


@cache
def _walks() -> list[tuple[rl.Motion, rl.Timeline]]:
    made = [
        synth.steps(6, treadmill=x, backward=y).motion for x, y in ((False, True), (True, False))
    ]
    motions = [*_MOTIONS[::2], *made, synth.gait("jacks", repetitions=5).motion]
    motions += [motion_of_points(synth.as_points(motion, gaps=0.2)) for motion in _MOTIONS[::4]]
    return [(motion, rl.understand(motion)) for motion in motions]


def _strides_of(motion: rl.Motion, timeline: rl.Timeline) -> Outcome:
    told = rl.strides(motion, rl.StrideOptions(resamples=100), timeline=timeline)
    known = [one for foot in told.summary.values() for one in foot.values() if one.count]
    figures = [x for one in known for x in (one.mean, one.low) if math.isfinite(x)]
    times = [stride.time for stride in told.strides]
    period = float(np.mean(times)) if times else 0.0
    return Outcome(1 + len(times), period, (*figures, float(len(told.notes))))


def _closed() -> Iterator[Outcome]:
    """The middle half of every second capture, joined and there and back."""
    for motion in _MOTIONS[::2]:
        for ping_pong in (False, True):
            options = CloseOptions(ping_pong=ping_pong)
            yield _guarded(lambda m=motion, o=options: _closed_half(m, o))


def _closed_half(motion: rl.Motion, options: CloseOptions) -> Outcome:
    closed = close_by_hand(motion, (len(motion) // 4, 3 * len(motion) // 4), options)
    return Outcome(1, closed.loop.duration, (*map(float, closed.frames), closed.apart))


def _drawn_anew() -> Iterator[Outcome]:
    """Four repetitions drawn of each capture that shows several."""
    return (_guarded(lambda m=motion: _drawn_of(m)) for motion in _MOTIONS)


def _drawn_of(motion: rl.Motion) -> Outcome:
    found = rl.repetitions(rl.find_cycles(motion)[0], motion)
    drawn = found.vary(4, rng=0)
    spread = float(rl.point_cloud(drawn).std(axis=0).mean())
    return Outcome(len(found), drawn.duration, (spread, _join_of(drawn)), slack=0.01)


def _join_of(motion: rl.Motion) -> float:
    """Return how hard the joints are accelerated at the join, over the most elsewhere."""
    points = rl.point_cloud(motion).reshape(len(motion), -1, 3)
    return join_ratio(points, len(points))


def _pointed() -> Iterator[Outcome]:
    """The captures as markers with gaps, outliers and noise."""
    for motion in _MOTIONS:
        size = motion.skeleton.size
        whole = synth.as_points(motion)
        hidden = synth.as_points(motion, gaps=0.2, outliers=0.02, noise=0.002 * size)
        yield _guarded(lambda h=hidden, w=whole, s=size: _cycle_of_points(h, w, s))


def _cycle_of_points(hidden: rl.Points, whole: rl.Points, size: float) -> Outcome:
    motion = motion_of_points(hidden)
    off = points_of_motion(motion).positions - whole.positions
    error = float(np.sqrt(np.mean(off[~hidden.seen] ** 2))) / size
    gaps = motion.skeleton.layout.gaps
    away = sum(gap.way == "open" for gap in gaps) / len(gaps)
    found = _guarded(lambda: _cycle_of(motion, Options()))
    return Outcome(found.number, found.period, (error, away), slack=0.002, failed=found.failed)


def _weighted() -> Iterator[Outcome]:
    options = Options(method="paper")
    return (_guarded(lambda m=motion: _cycle_of(m, options)) for motion in _MOTIONS)


def _cycle_of(motion: rl.Motion, options: Options) -> Outcome:
    cycles = rl.find_cycles(motion, options)
    first = cycles[0]
    pace = float(np.linalg.norm(first.pose(np.arange(32) / 32, derivative=1)))
    travel = float(np.linalg.norm(first.travel)) / motion.skeleton.size
    above = 0.0 if first.above is None else float(len(first.above.places))
    sure = first.evidence.confidence or 0.0
    figures = (sure, first.evidence.repetitions, pace, travel, above)
    return Outcome(len(cycles), first.period, figures)


def _loops() -> Iterator[Outcome]:
    """Loops take longer: of every second capture."""
    return (_guarded(lambda m=motion: _looped(m)) for motion in _MOTIONS[::2])


def _looped(motion: rl.Motion) -> Outcome:
    """Find, repair and measure, as a loop is made."""
    cycles = rl.find_cycles(motion)
    first = cycles[0]
    mended, turns = repaired(first, source_parts(first, motion))
    measured = rl.quality(mended, motion)
    judged = verdict_of(mended, motion, mended.sample(), measured)
    stands = foot_contacts(mended, motion.fps)
    stood = sum(stop - start for spans in stands.values() for start, stop in spans)
    figures = (
        measured.template_error,
        measured.loop_jerk,
        measured.loop_skate,
        measured.capture_velocity,
        measured.coverage,
        stood / (first.period * motion.fps),
        float(len(stands)),
        float(len(turns)),
        Lengths.of(motion.skeleton).metres or 0.0,
        float(len(judged.reasons)),
        float(len(judged.word)),
        *sorted(one.angle for one in turns),
    )
    return Outcome(len(cycles), first.period, figures)


def _linted() -> Iterator[Outcome]:
    for loop in _faulty():
        found = [len(lint(motion, loop.wraps, loop.phase)) for motion in loop.motions]
        yield Outcome(1 + sum(found), 0.0, tuple(map(float, found)))


@dataclass(frozen=True)
class _Faulty:
    """A loop as it is and with each fault at its least, and how they are judged."""

    wraps: bool
    phase: float | None
    motions: list[rl.Motion]


@cache
def _faulty() -> list[_Faulty]:
    """Every second loop is judged as a glTF; gaits are their own set."""
    made = []
    for number, cycle in enumerate(_cycles()):
        motion = cycle.sample()
        if len(motion) < 12:
            continue
        phase, wraps = taken_apart(motion, wraps=False).phase, bool(number % 2)
        motion = motion.scaled(METRES / motion.skeleton.size)
        loop = Loop("", "", "", phase is not None, wraps, motion, phase=phase)
        faulty = (put(loop, strengths[0]) for put, strengths in FAULTS.values())
        motions = [in_form(loop), *(one for one in faulty if one is not None)]
        made.append(_Faulty(wraps, phase, motions))
    return made


def _upright() -> Iterator[Outcome]:
    for motion in _MOTIONS:
        yield Outcome(1 + vertical_axis(motion.positions(), motion.skeleton.size))


def _cycles() -> list[rl.Cycle]:
    found = []
    for motion in _MOTIONS:
        try:
            found.append(rl.find_cycles(motion)[0])
        except rl.RoundelayError:
            continue
    return found


@cache
def _by_body() -> list[list[rl.Cycle]]:
    bodies: dict[tuple[str, ...], list[rl.Cycle]] = {}
    for cycle in _cycles():
        bodies.setdefault(cycle.skeleton.names, []).append(cycle)
    return [cycles for cycles in bodies.values() if len(cycles) > 1]


def _library() -> Iterator[Outcome]:
    """All cycles as one library: the group of each and how many share it."""
    parts: dict[Body, list[np.ndarray]] = {}
    for cycles in _by_body():
        packed = Packed.of(Spectra.of(cycles))
        parts.setdefault(packed.body, []).append(packed.values)
    for body, values in parts.items():
        packed = Packed(body, np.concatenate(values))
        shelf = Shelf(np.arange(len(packed)), packed)
        labels = assigned([shelf], np.full(len(packed), -1), {}).labels
        named = {label: str(label) for label in set(labels.tolist()) if label % 2}
        alike = nearest_named([shelf], labels, named) if named else {}
        for label in labels.tolist():
            yield Outcome(int(np.sum(labels == label)), float(alike.get(label, -1)), ())


def _aligned() -> Iterator[Outcome]:
    for first, *others in _by_body():
        for other in others:
            found = align(first, other, mirror=True)
            yield Outcome(1, 0.0, (found.distance, found.offset, float(found.mirrored)))


def _classes() -> Iterator[Outcome]:
    return (_guarded(lambda m=motion: _topology(m)) for motion in _MOTIONS)


def _topology(motion: rl.Motion) -> Outcome:
    """Classes of a whole capture, the first two decorrelated."""
    points = point_cloud(motion)[:: max(1, len(motion) // 300)]
    barcode = persistent_cohomology(points)
    try:
        pair = toroidal_coordinates(barcode)
    except ValueError:
        # There are no two that live together.
        pair = ()
    figures = [value for one in pair for value in turns(one.phase, [(0, len(points))])]
    return Outcome(1 + count_classes(barcode), 0.0, (*figures, *(one.scale for one in pair)))


@cache
def _labelled() -> tuple[list[Any], list[tuple[rl.Motion, rl.Timeline]]]:
    """Captures with labels; and motions with their timelines, which no cut changes."""
    data, truth = _PLACE[0], _PLACE[0] / "truth"
    motions = [rl.read(data / "cmu" / "acclaim" / n[:2] / f"{n}.amc") for n in FULL]
    for joined in (hdm_joins(truth, 2), bandai_joins(truth, 2), clip_joins(truth, 2)):
        motions += [take.motion for take in joined]
    return labelled(data), [(motion, rl.understand(motion)) for motion in motions]


def _behaviours() -> Iterator[Outcome]:
    channels, motions = _labelled()
    for motion, told in motions:
        yield _cut(rl.segment(motion, timeline=told))
        yield _cut(rl.segment(motion, timeline=told, n_segments=5))
    for capture in channels:
        yield _cut(segment_channels(capture.values, capture.fps))


def _with(method: Any) -> Iterator[Outcome]:
    """The methods of [B] take longer: three captures."""
    for capture in _labelled()[0][1:4]:
        found = segment_channels(capture.values, capture.fps, method=method)
        yield _cut(found)


def _pca() -> Iterator[Outcome]:
    return _with("pca")


def _ppca() -> Iterator[Outcome]:
    yield from _with(PPCAOptions())
    yield from _with(PPCAOptions.paper())


def _gmm() -> Iterator[Outcome]:
    return _with(GMMOptions())


def _cut(found: rl.Segmentation) -> Outcome:
    seconds = [segment.start * found.frame_time for segment in found.segments]
    labels = [float(segment.label) for segment in found.segments]
    return Outcome(len(found), 0.0, (*seconds, *labels), slack=0.25)


if __name__ == "__main__":
    main()
