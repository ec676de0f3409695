"""What repeats in 307 captures with truth, in joined and in random takes, by default options.

Usage: python -m benchmarks.truth --data FOLDER [--json] [--only stretches,counts] [--quick]

Given by default is what has a probability of one half or more. The sections:

- ``stretches``: frames in which feet or hands repeat; right is a period within 10 %
  on 60 % of the frames, by the joints that move. ``half_double`` of them
  are given at half or twice their period instead; ``besides`` tells how many behaviours are given
  a stretch, and how many takes give one joint two behaviours on one frame;
- ``yardstick``: the share of all that is given whose joints come back after the period by an
  autocorrelation that imports nothing of the search, and not more so after half or twice of it;
- ``throughout``: captures of one gait from end to end; ``one_shots``: captures of a single
  movement that are called cyclic; ``closed``: loops that a person cut and closed;
  ``negatives``: windows in which nothing comes back of which something cyclic covers 60 %;
- ``counts``: cuts of one repetition each, joined: are as many counted, in any order;
- ``calibration``: probabilities against the yardstick, also in random crops and joined takes;
- ``synergies``: random smooth motion that is called cyclic.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks import _truth_data as data
from benchmarks._answers import Found, answers
from benchmarks._harness import Target, parser, report
from benchmarks._truth_data import Capture, Joined, Random, Stretch
from benchmarks._yardstick import Body, body, ends_apart, measured
from roundelay.library.workers import spread

SECTIONS = {
    "stretches": lambda capture: bool(capture.stretches),
    "throughout": lambda capture: capture.period is not None,
    "one_shots": lambda capture: capture.kind in ONE_SHOTS,
    "closed": lambda capture: True,
    "negatives": lambda capture: bool(capture.negatives),
    "yardstick": lambda capture: True,
    "calibration": lambda capture: True,
}
ONE_SHOTS = ("one-shot", "single repetition")
TARGETS = (
    Target("stretches.bandai", ">=", 0.96, "stretches of bandai found"),
    Target("stretches.snu", ">=", 0.96, "stretches of snu found"),
    Target("stretches.cmu", ">=", 0.96, "stretches of cmu found"),
    Target("stretches.lafan1", ">=", 0.85, "stretches of lafan1 found"),
    Target("stretches.dog", ">=", 0.85, "stretches of dog found"),
    Target("half_double", "<=", 0.01, "half double"),
    Target("besides.behaviours_a_stretch", "<=", 1.3, "besides: behaviours a stretch"),
    Target("besides.frames_in_two", "<=", 0, "besides: frames in two"),
    Target("yardstick", ">=", 0.96, "yardstick"),
    Target("throughout", ">=", 0.99, "throughout"),
    Target("one_shots", "<=", 0.03, "one shots"),
    Target("closed.at_length", ">=", 20, "closed: at length"),
    Target("closed.at_half", "<=", 0, "closed: at half"),
    Target("closed.ends_apart", "<=", 0, "closed: ends apart"),
    Target("negatives", "<=", 0.04, "negatives"),
    Target("counts.gestures", ">=", 0.9, "counts: gestures"),
    Target("counts.deposit_grab", ">=", 0.6, "counts: deposit grab"),
    Target("counts.same_in_any_order", ">=", 1.0, "counts: same in any order"),
    Target("calibration_error.any_source", "<=", 0.05, "calibration error: any source"),
    Target("calibration_error.pooled", "<=", 0.03, "calibration error: pooled"),
    Target("above_95_wrong.share", "<=", 0.02, "above 95 wrong: share"),
    Target("above_95_wrong.of", ">=", 300, "above 95 wrong: of"),
    Target("above_95_wrong.right_above_half", ">=", 0.95, "above 95 wrong: right above half"),
    Target("synergies.three_to_eight", "<=", 0.02, "synergies: three to eight"),
    Target("synergies.two_or_one_joint", "<=", 0.06, "synergies: two or one joint"),
    Target("synergies.surest_of_two", "<=", 0.9, "synergies: surest of two"),
)
# Bounds of the probabilities that are told of together.
BINS = (0.0, 0.2, 0.5, 0.8, 0.95, 1.0)
# Ends further apart than this share of the poses' deviation, or of the speed, do not meet: those
# of the worst of 20 loops that people closed are .09 and 1.75 apart.
_POSE_APART, _SPEED_APART = 0.15, 2.0


@dataclass(frozen=True)
class Judged:
    """A behaviour, and what the yardstick says of it."""

    found: Found
    half: float
    once: float
    twice: float
    right: bool
    # Of a closed pass: how far apart its ends are, in pose and velocity.
    apart: tuple[float, float] | None = None


@dataclass(frozen=True)
class StretchRow:
    """A stretch, and what is given there."""

    stretch: Stretch
    right: bool
    half_double: bool
    given: int
    # Of the behaviour that covers most: period over the stretch's own, part covered, limbs' share.
    ratio: float | None
    covered: float
    share: float


@dataclass(frozen=True)
class Row:
    """All that is measured in one capture, crop, joined or random take."""

    name: str
    source: str
    # Of the processor, for the answer alone.
    seconds: float
    frames: int
    behaviours: tuple[Judged, ...] = ()
    stretches: tuple[StretchRow, ...] = ()
    negatives: tuple[float, ...] = ()
    frames_in_two: int = 0
    counts: tuple[float, float] | None = None
    task: Any = field(default=None, repr=False)
    error: str = ""


def main() -> None:
    asked = parser(__doc__, data="folder that holds truth/")
    asked.add_argument("--rows", action="store_true", help="print what was found in every take")
    asked.add_argument("--only", help="sections, separated by commas")
    asked.add_argument("--files", default="", help="captures whose names hold this alone")
    asked.add_argument("--quick", action="store_true", help="fewer takes and seeds, no crops")
    asked.add_argument("--seeds", type=int, help="of random takes: 100, or 4 with --quick")
    asked.add_argument("--least", type=float, default=0.5, help="probability that is given")
    asked.add_argument("--jobs", type=int, default=2, help="processes, of one thread each")
    arguments = asked.parse_args()
    sections = _sections(asked, arguments.only)
    folder = arguments.data / "truth" if (arguments.data / "truth").is_dir() else arguments.data
    seeds = arguments.seeds or (4 if arguments.quick else 100)
    tasks = list(_tasks(folder, sections, arguments.quick, seeds, arguments.files))
    started = time.perf_counter()
    rows = _measured(tasks, folder, arguments.least, arguments.jobs)
    summary = _summary(rows, sections, arguments.least)
    result = {
        "summary": summary,
        "failed": [f"{row.name}: {row.error}" for row in rows if row.error],
        "details": _details(rows, arguments.least),
        "seconds": round(time.perf_counter() - started, 1),
        "rows": [_plain(row) for row in rows],
    }
    targets = [target for target in TARGETS if target.path.partition(".")[0] in summary]
    shown = rows if arguments.rows else ()
    table = [line for row in shown for line in _lines(row, arguments.least)]
    report("truth", result, targets, arguments, table=table, bulk=["rows"])


def _sections(asked: argparse.ArgumentParser, only: str | None) -> set[str]:
    known = {*SECTIONS, "counts", "synergies"}
    chosen = set(only.split(",")) if only else known
    if unknown := chosen - known:
        asked.error(f"expected sections among {sorted(known)}, found {sorted(unknown)}")
    return chosen


def _tasks(folder: Path, sections: set[str], quick: bool, seeds: int, files: str) -> Iterator[Any]:
    """Yield captures, crops (a capture and its frames), joined and random takes."""
    table = data.captures(folder)
    needed = [c for c in table if any(s in sections and SECTIONS[s](c) for s in SECTIONS)]
    needed = [c for c in needed if files in c.file]
    yield from needed
    if "calibration" in sections and not quick:
        rng = np.random.default_rng(20261127)
        for capture in needed:
            yield capture, (rng.uniform(0.4, 0.9), rng.uniform())
    if "counts" in sections:
        yield from data.joins(table, 36 if quick else 100)
    if "synergies" in sections:
        yield from data.random_takes(seeds)


def _measured(tasks: list[Any], folder: Path, least: float, jobs: int) -> list[Row]:
    """Measure in processes of one thread, the longest takes first; tell of it on stderr."""
    tasks = sorted(tasks, key=lambda task: -_length(task, folder))
    rows: list[Row] = []
    work, told = partial(_row, folder, least), time.perf_counter()
    for row in spread(work, tasks, jobs, _lost):
        rows.append(row)
        if row.error:
            print(f"{row.name}: {row.error}", file=sys.stderr)
        if time.perf_counter() > told + 5 or len(rows) == len(tasks):
            told = time.perf_counter()
            print(f"{len(rows)} of {len(tasks)} takes", file=sys.stderr, flush=True)
    return sorted(rows, key=lambda row: row.name)


def _length(task: Any, folder: Path) -> float:
    """Estimate how long a take is, in bytes of its file."""
    if isinstance(task, Random):
        return 3000.0 * task.seconds
    return float((folder / task.file).stat().st_size) if isinstance(task, Capture) else 0.0


def _lost(task: Any) -> Row:
    return Row(_name(task), "", 0.0, 0, error="the process died", task=task)


def _name(task: Any) -> str:
    if isinstance(task, Capture):
        return task.file
    if isinstance(task, Joined):
        return f"joined {task.label} {' '.join(Path(f).stem.split('_')[-2] for f in task.files)}"
    if isinstance(task, Random):
        return (
            f"random {task.synergies} synergies {task.joints} joints"
            f" {task.seconds} s seed {task.seed}"
        )
    capture, (part, place) = task
    return f"crop {capture.file} {part:.2f} {place:.2f}"


def _row(folder: Path, least: float, task: Any) -> Row:
    try:
        if isinstance(task, Capture):
            return _capture_row(folder, least, task)
        if isinstance(task, Joined):
            return _joined_row(folder, least, task)
        if isinstance(task, Random):
            return _plain_row(task, "random", data.random_motion(task))
        capture, (part, place) = task
        motion = rl.read(folder / capture.file)
        length = round(part * len(motion))
        start = round(place * (len(motion) - length))
        return _plain_row(task, capture.source, motion[start : start + length])
    except Exception as error:  # one failure is told of, and costs its take alone
        return Row(_name(task), "", 0.0, 0, error=f"{type(error).__name__}: {error}", task=task)


def _plain_row(task: Any, source: str, motion: rl.Motion) -> Row:
    started = time.process_time()
    found = answers(motion)
    seconds = time.process_time() - started
    seen = body(motion) if found and source != "random" else None
    judged = tuple(_judged(seen, each) for each in found)
    return Row(_name(task), source, seconds, len(motion), judged, task=task)


def _judged(seen: Body | None, found: Found) -> Judged:
    if seen is None:
        return Judged(found, np.nan, np.nan, np.nan, False)
    if found.kind == "closed":
        apart = ends_apart(seen, found.joints, found.spans[0])
        meet = bool(apart[0] <= _POSE_APART and apart[1] <= _SPEED_APART)
        return Judged(found, np.nan, np.nan, np.nan, meet, apart)
    how = measured(seen, found.joints, found.spans, found.period)
    return Judged(found, how.half, how.once, how.twice, how.passes)


def _capture_row(folder: Path, least: float, capture: Capture) -> Row:
    motion = rl.read(folder / capture.file)
    row = _plain_row(capture, capture.source, motion)
    seen, given = body(motion), _given(row, least)
    return replace(
        row,
        stretches=tuple(_stretch_row(seen, given, each) for each in capture.stretches),
        negatives=tuple(_covered(seen, given, *window) for window in capture.negatives),
        frames_in_two=_frames_in_two([*given, *_passes(row)], len(motion)),
    )


def _given(row: Row, least: float) -> list[Found]:
    """Return what is cyclic and given by default."""
    return [each.found for each in _given_judged(row, least)]


def _given_judged(row: Row, least: float) -> list[Judged]:
    return [
        each
        for each in row.behaviours
        if each.found.kind == "cyclic" and (each.found.probability or 0.0) >= least
    ]


def _passes(row: Row) -> list[Found]:
    """Return what is closed: one pass whose ends meet."""
    return [each.found for each in row.behaviours if each.found.kind == "closed"]


def _stretch_row(seen: Body, given: list[Found], stretch: Stretch) -> StretchRow:
    frames = stretch.start, stretch.stop
    length = stretch.stop - stretch.start
    here = [each for each in given if each.within(*frames) >= 0.1 * length]
    same = [each for each in here if seen.shows(stretch.limbs, each.joints, frames)]
    wide = [each for each in same if each.within(*frames) >= 0.6 * length]
    near = [each for each in same if _near(each.period, stretch.period)]
    right = _together(near, frames) >= 0.6 * length
    other = any(_near(each.period, many * stretch.period) for each in wide for many in (0.5, 2.0))
    most = max(here, key=lambda each: each.within(*frames), default=None)
    if most is None:
        return StretchRow(stretch, False, False, 0, None, 0.0, 0.0)
    return StretchRow(
        stretch,
        right,
        other and not right,
        len(here),
        most.period / stretch.period,
        most.within(*frames) / length,
        seen.share(stretch.limbs, most.joints, frames),
    )


def _together(found: list[Found], frames: tuple[int, int]) -> int:
    """Count the frames that any of some behaviours covers."""
    covered = np.zeros(frames[1], bool)
    for each in found:
        for start, stop in each.spans:
            covered[start:stop] = True
    return int(covered[frames[0] :].sum())


def _near(period: float, right: float) -> bool:
    return abs(period / right - 1.0) <= 0.1


def _covered(seen: Body, given: list[Found], start: int, stop: int) -> float:
    """Return the largest part of a window that one behaviour of legs or arms covers."""
    limbs = {seen.names[joint] for limb in (*seen.feet, *seen.hands) for joint in limb}
    inside = [each.within(start, stop) for each in given if limbs & set(each.joints)]
    return max(inside, default=0) / (stop - start)


def _frames_in_two(given: list[Found], frames: int) -> int:
    """Count frames in which a joint is in two behaviours."""
    joints = sorted({joint for each in given for joint in each.joints})
    used = np.zeros((frames, len(joints)), np.int8)
    for each in given:
        named = [joints.index(joint) for joint in each.joints]
        for start, stop in each.spans:
            used[start:stop, named] += 1
    return int((used > 1).any(axis=1).sum()) if joints else 0


def _joined_row(folder: Path, least: float, joined: Joined) -> Row:
    """Judge the first order; of the second, the count alone is told."""
    motions = {file: rl.read(folder / file) for file in joined.files}
    row = _plain_row(joined, "hdm05", data.joined([motions[file] for file in joined.files]))
    again = _plain_row(joined, "hdm05", data.joined([motions[file] for file in joined.again]))
    counts = _count(_given(row, least)), _count(_given(again, least))
    return replace(row, counts=counts)


def _count(given: list[Found]) -> float:
    """Return the repetitions of what the most joints show the longest."""
    most = max(given, key=lambda each: each.frames * len(each.joints), default=None)
    return 0.0 if most is None else most.repetitions


def _summary(rows: list[Row], sections: set[str], least: float) -> dict[str, Any]:
    whole = [row for row in rows if isinstance(row.task, Capture)]
    asked = {
        "stretches": ("stretches", partial(_stretch_shares, whole)),
        "half_double": ("stretches", partial(_half_double, whole)),
        "besides": ("stretches", partial(_besides, whole)),
        "yardstick": ("yardstick", partial(_yardstick, whole, least)),
        "throughout": ("throughout", partial(_throughout, whole, least)),
        "one_shots": ("one_shots", partial(_one_shots, whole, least)),
        "closed": ("closed", partial(_closed, whole, least)),
        "negatives": ("negatives", partial(_negatives, whole)),
        "counts": ("counts", partial(_counts, rows)),
        "calibration_error": ("calibration", partial(_calibration, rows)),
        "above_95_wrong": ("calibration", partial(_above_95, rows)),
        "synergies": ("synergies", partial(_synergies, rows, least)),
    }
    return {key: value() for key, (section, value) in asked.items() if section in sections}


def _share(values: Iterable[bool]) -> float:
    kept = list(values)
    return round(sum(kept) / len(kept), 4) if kept else float("nan")


def _stretch_shares(rows: list[Row]) -> dict[str, float]:
    sources = sorted({row.source for row in rows if row.stretches})
    return {s: _share(e.right for r in rows if r.source == s for e in r.stretches) for s in sources}


def _half_double(rows: list[Row]) -> float:
    return _share(each.half_double for row in rows for each in row.stretches)


def _besides(rows: list[Row]) -> dict[str, float]:
    given = [each.given for row in rows for each in row.stretches if each.given]
    return {
        "behaviours_a_stretch": round(float(np.mean(given)), 3) if given else 0.0,
        "takes_with_frames_in_two": sum(row.frames_in_two > 0 for row in rows),
        "frames_in_two": sum(row.frames_in_two for row in rows),
    }


def _yardstick(rows: list[Row], least: float) -> float:
    return _share(each.right for row in rows for each in _given_judged(row, least))


def _throughout(rows: list[Row], least: float) -> float:
    return _share(_right_throughout(row, least) for row in rows if row.task.period is not None)


def _right_throughout(row: Row, least: float) -> bool:
    return any(
        _near(each.period, row.task.period) and each.frames >= 0.6 * row.frames
        for each in _given(row, least)
    )


def _one_shots(rows: list[Row], least: float) -> float:
    return _share(bool(_given(row, least)) for row in rows if row.task.kind in ONE_SHOTS)


def _closed(rows: list[Row], least: float) -> dict[str, int]:
    """Count loops closed by a person that are found; and passes anywhere whose ends are apart."""
    loops = [row for row in rows if row.task.kind == "closed loop"]
    passes = [b for row in rows for b in row.behaviours if b.found.kind == "closed"]
    return {
        "of": len(loops),
        "at_length": sum(_at(row, 1.0, least) for row in loops),
        "at_half": sum(_at(row, 0.5, least) for row in loops),
        "passes": len(passes),
        "ends_apart": sum(not each.right for each in passes),
    }


def _at(row: Row, part: float, least: float) -> bool:
    """Tell whether a part of the file's length is given as a period or as one pass."""
    seconds = part * row.task.frames / row.task.fps
    found = [*_given(row, least), *_passes(row)]
    return any(abs(each.period / seconds - 1.0) <= 0.05 for each in found)


def _negatives(rows: list[Row]) -> float:
    return _share(part >= 0.6 for row in rows for part in row.negatives)


def _counts(rows: list[Row]) -> dict[str, float]:
    joined = [row for row in rows if isinstance(row.task, Joined)]
    counts = [row.counts for row in joined if row.counts is not None]

    def right(wanted: Callable[[str], bool]) -> float:
        return _share(_counted(row) for row in joined if wanted(row.task.label))

    return {
        "gestures": right(lambda label: label not in data.UNLIKE),
        "deposit_grab": right(lambda label: label in data.UNLIKE),
        "same_in_any_order": _share(abs(one - other) <= 0.5 for one, other in counts),
        "takes": len(joined),
    }


def _counted(row: Row) -> bool:
    return row.counts is not None and abs(row.counts[0] - row.task.count) <= 0.5


def _judgements(rows: list[Row]) -> list[tuple[str, float, bool]]:
    """List source, probability and truth of all that is called cyclic, however unsure."""
    return [
        (row.source, each.found.probability, each.right)
        for row in rows
        if row.source != "random"
        for each in row.behaviours
        if each.found.kind == "cyclic" and each.found.probability is not None
    ]


def _calibration(rows: list[Row]) -> dict[str, Any]:
    """Return calibration errors of sources with 50 cycles and more, their worst, and of all."""
    judged = _judgements(rows)
    sources = sorted({source for source, _, _ in judged})
    own = {s: [(p, right) for source, p, right in judged if source == s] for s in sources}
    errors = {s: round(_error(own[s]), 4) for s in sources if len(own[s]) >= 50}
    return {
        **errors,
        "any_source": max(errors.values(), default=float("nan")),
        "pooled": round(_error([(p, right) for _, p, right in judged]), 4),
        "of": {s: len(own[s]) for s in sources},
    }


def _error(judged: list[tuple[float, bool]]) -> float:
    """Return the expected calibration error."""
    binned = _reliability(judged)
    off = [each["of"] * abs(each["mean"] - each["right"]) for each in binned]
    return sum(off) / max(sum(each["of"] for each in binned), 1)


def _reliability(judged: Sequence[tuple[float, bool]]) -> list[dict[str, float]]:
    table = np.array(judged, float).reshape(-1, 2)
    place = np.digitize(table[:, 0], BINS[1:-1])
    return [
        {
            "from": BINS[i],
            "to": BINS[i + 1],
            "of": int((place == i).sum()),
            "mean": round(float(table[place == i, 0].mean()), 4),
            "right": round(float(table[place == i, 1].mean()), 4),
        }
        for i in range(len(BINS) - 1)
        if (place == i).any()
    ]


def _above_95(rows: list[Row]) -> dict[str, float]:
    judged = _judgements(rows)
    sure = [right for _, p, right in judged if p > 0.95]
    return {
        "share": _share(not right for right in sure),
        "of": len(sure),
        "wrong": sum(not right for right in sure),
        "right_above_half": _share(p > 0.5 for _, p, right in judged if right),
    }


def _synergies(rows: list[Row], least: float) -> dict[str, float]:
    random = [row for row in rows if isinstance(row.task, Random)]
    few = [row for row in random if row.task.synergies == 2 or row.task.joints == 1]
    many = [row for row in random if row not in few]
    surest = [each.found.probability for row in few for each in _given_judged(row, least)]
    return {
        "three_to_eight": _share(bool(_given(row, least)) for row in many),
        "two_or_one_joint": _share(bool(_given(row, least)) for row in few),
        "surest_of_two": round(max((p for p in surest if p is not None), default=0.0), 4),
        "takes": len(random),
    }


def _details(rows: list[Row], least: float) -> dict[str, Any]:
    """Tell what the summary does not: by kinds of takes."""
    whole = [row for row in rows if isinstance(row.task, Capture)]
    judged = [(p, right) for _, p, right in _judgements(rows)]
    listed = [each for row in whole for each in row.stretches]
    labels = sorted({row.task.label for row in rows if isinstance(row.task, Joined)})
    return {
        "stretches": {
            limbs: f"{sum(e.right for e in own)} of {len(own)}"
            for limbs in ("feet", "hands")
            if (own := [e for e in listed if e.stretch.limbs == limbs])
        },
        "counts": {
            label: f"{sum(map(_counted, own))} of {len(own)}"
            for label in labels
            if (own := [r for r in rows if isinstance(r.task, Joined) and r.task.label == label])
        },
        "synergies": _synergy_details(rows, least),
        "given": sum(len(_given(row, least)) for row in whole),
        "reliability": _reliability(judged),
        "frames_a_second": round(
            sum(row.frames for row in rows) / max(sum(row.seconds for row in rows), 1e-9)
        ),
    }


def _synergy_details(rows: list[Row], least: float) -> dict[str, str]:
    kinds: dict[str, list[Row]] = {}
    for row in rows:
        if isinstance(row.task, Random):
            kinds.setdefault(row.name.split(" seed")[0], []).append(row)
    return {
        kind: f"{sum(bool(_given(row, least)) for row in own)} of {len(own)}"
        for kind, own in sorted(kinds.items())
    }


def _lines(row: Row, least: float) -> Iterator[str]:
    """Tell of a take in a line, and of its stretches and behaviours in one each."""
    known = "" if row.task is None else getattr(row.task, "kind", "")
    if row.counts is not None:
        known = f"counted {row.counts[0]:.1f}, {row.counts[1]:.1f} of {row.task.count}"
    period = getattr(row.task, "period", None)
    throughout = "" if period is None else f"  throughout {period:.2f} s"
    yield f"{row.name}  {row.frames} frames  {known}{throughout}  {row.error}".rstrip()
    for each in row.stretches:
        s = each.stretch
        told = "right" if each.right else "HALF OR DOUBLE" if each.half_double else "WRONG"
        ratio = "-" if each.ratio is None else f"{each.ratio:.2f}"
        yield (
            f"    stretch {s.start}-{s.stop} {s.limbs} {s.period:.2f} s: {told}  {each.given} given"
            f"  period x {ratio}  covered {each.covered:.2f}  limbs {each.share:.2f}"
        )
    if row.negatives and max(row.negatives) >= 0.6:
        yield f"    negatives covered {[round(part, 2) for part in row.negatives]}"
    for judged in row.behaviours:
        yield "    " + _line(judged, least)


def _line(judged: Judged, least: float) -> str:
    found = judged.found
    sure = "-" if found.probability is None else f"{found.probability:.2f}"
    spans = " ".join(f"{start}-{stop}" for start, stop in found.spans)
    told = f"r {judged.half:.2f} {judged.once:.2f} {judged.twice:.2f}"
    if judged.apart is not None:
        told = f"ends apart {judged.apart[0]:.2f} {judged.apart[1]:.2f}"
    given = found.probability is None or found.probability >= least
    return (
        f"{found.kind}{'' if given else ' (not given)'}  p {sure}  {found.period:.2f} s"
        f" x {found.repetitions:.1f}  {len(found.joints)} joints  {told}"
        f"  {'right' if judged.right else 'WRONG'}  frames {spans}"
    )


def _plain(row: Row) -> dict[str, Any]:
    return {**asdict(row), "task": None}


if __name__ == "__main__":
    main()
