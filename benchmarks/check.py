"""Faults put into clean loops: how many `roundelay check` finds, and how often it is wrong.

Usage: python -m benchmarks.check --data FOLDER [--loops 200] [--jobs 2] [--json] [--keep]

Clean loops are 20 that people made by hand (in FOLDER/truth/captures.csv: "closed loop") and the
first cycles of captures drawn evenly from FOLDER/truth and FOLDER/cmu, as `Cycle.sample` gives
them; cycles of gaits begin where the left foot comes down. Every second loop is judged as a BVH,
the others as a glTF: in metres, ending with its first frame. Nine faults are put into each loop
that can have them, at three strengths:

- frame too many: the first 1, 2, 3 frames again; frame missing: the last 1, 2, 3;
- pop: all joints but the root turn steadily, so that one jumps at the join by 3, 6, 12 times the
  largest second difference elsewhere;
- foot slide: the root is .15, .3, .6 body sizes a second faster, where feet stand;
- drift: it climbs by .04, .08, .16 body sizes a period;
- rate: strides take 3, 4, 5 times as long (gaits);
- unit: lengths are 10, 39.37, 100 times larger, or smaller (glTF);
- root bob: a root bone on the ground goes up and down by .01, .02, .04 body sizes;
- phase: gaits begin .2, .3, .5 turns later than the others of their source and class.

`check_found` is the share of faults that are named, `check_false` that of the clean loops in which
one is found. The limits were chosen on every second source (a folder, of CMU and of hand-made loops
a person); the figures are those of the other sources, `chosen_on` has those of the first.
"""

from __future__ import annotations

import csv
import multiprocessing
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks.raunio import RUNS, WALKS
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import left_and_right
from roundelay.geometry.skeleton import Skeleton
from roundelay.loops.lint import lint, phase_of_set, taken_apart
from roundelay.loops.mend import continued, mended
from roundelay.loops.unrolled import body_path, seen, steps_of

TARGETS = (
    Target("check_found", ">=", 0.98, "faults that are named"),
    Target("check_false", "<=", 0.02, "clean loops in which a fault is found"),
)
HAND_MADE = 20
LONGEST = 6000
METRES = 1.9
GAITS = ("gait", "closed loop")


# A path, its source, its class, and whether that is a gait.
Known = tuple[Path, str, str, bool]


@dataclass(frozen=True, eq=False)
class Loop:
    """A clean loop, one period without a repeated first frame."""

    name: str
    source: str
    # Source and class.
    kind: str
    gait: bool
    wraps: bool
    motion: rl.Motion
    # Whether it begins where the left foot comes down; the phase of such gaits of its source.
    begun: bool = False
    phase: float | None = None


Faulty = Callable[[Loop, float], rl.Motion | None]


def main() -> None:
    options = parser(__doc__, data="folder that holds cmu/, truth/")
    options.add_argument("--loops", type=int, default=200, help="how many are drawn")
    options.add_argument("--jobs", type=int, default=2, help="processes")
    arguments = options.parse_args()
    drawn = loops(arguments.data, arguments.loops, arguments.jobs)
    with multiprocessing.Pool(arguments.jobs, _quiet) as pool:
        rows = pool.map(judged, drawn, chunksize=4)
    halves = halved(rows)
    shown = figures(halves[1])
    summary = {name: shown[name] for name in ("check_found", "check_false")}
    summary |= {"loops": len(rows), "gaits": sum(row["gait"] for row in rows)}
    result = {"summary": summary, "shown_on": shown, "chosen_on": figures(halves[0]), "rows": rows}
    report("check", result, TARGETS, arguments, table=table(result), bulk=("rows",))


def _quiet() -> None:
    warnings.simplefilter("ignore")


# Clean loops ---------------------------------------------------------------------------------


def loops(data: Path, count: int, jobs: int) -> list[Loop]:
    """Hand-made loops, and cycles of captures drawn evenly, until there are enough."""
    hand_made, captures = listed(data)
    made = [_loop(known, rl.read(known[0])) for known in hand_made]
    with multiprocessing.Pool(jobs, _quiet) as pool:
        found = [one for one in pool.map(first_cycle, captures, chunksize=4) if one is not None]
    wanted = min(count - len(made), len(found))
    places = np.linspace(0, len(found) - 1, wanted).astype(int)
    made += [found[place] for place in places]
    formed = [replace(one, wraps=bool(number % 2)) for number, one in enumerate(made)]
    return with_phases([_in_metres(one) if one.wraps else one for one in formed])


def listed(data: Path) -> tuple[list[Known], list[Known]]:
    """Paths, sources and whether they show a gait: hand-made loops, captures."""
    with (data / "truth" / "captures.csv").open(newline="", encoding="utf-8") as lines:
        rows = [row for row in csv.DictReader(lines) if row["kind"] != "noisy"]
    hand_made, captures = [], []
    for row in rows:
        path = data / "truth" / row["file"]
        one = path, source_of(row["source"], path), row["class"], row["kind"] in GAITS
        (hand_made if row["kind"] == "closed loop" else captures).append(one)
    acclaim = sorted((data / "cmu" / "acclaim").rglob("*.amc"))
    for path in acclaim:
        label = "walk" if path.stem in WALKS else "run" if path.stem in RUNS else ""
        captures.append((path, source_of("cmu", path), label, bool(label)))
    return hand_made[:HAND_MADE], captures


def source_of(folder: str, path: Path) -> str:
    """The folder; of CMU and hand-made loops the person, too."""
    person = path.stem.split("_")[0] if folder in ("cmu", "handloop") else ""
    return f"{folder} {person}".strip()


def first_cycle(capture: Known) -> Loop | None:
    """The first cycle of a capture; none where there is none, or in very long takes."""
    path = capture[0]
    motion = rl.read(path)
    if len(motion) > LONGEST:
        return None
    try:
        sampled = rl.find_cycles(motion)[0].sample()
    except rl.RoundelayError:
        return None
    return _loop(capture, sampled) if len(sampled) > 11 else None


def _loop(known: Known, motion: rl.Motion) -> Loop:
    path, source, label, gait = known
    return Loop(path.name, source, f"{source} {label}", gait, False, motion)


def _in_metres(loop: Loop) -> Loop:
    return replace(loop, motion=loop.motion.scaled(METRES / loop.motion.skeleton.size))


def with_phases(made: list[Loop]) -> list[Loop]:
    """Let gaits begin where the left foot comes down; tell each the phase of its source."""
    begun = [
        begun_left(one) if one.gait and not one.source.startswith("handloop") else one
        for one in made
    ]
    phases: dict[str, list[float]] = defaultdict(list)
    for one in begun:
        phase = taken_apart(one.motion, wraps=False).phase if one.begun else None
        if phase is not None:
            phases[one.kind].append(phase)
    agreed = {kind: phase_of_set(found) for kind, found in phases.items()}
    return [replace(one, phase=agreed.get(one.kind) if one.begun else None) for one in begun]


def begun_left(loop: Loop) -> Loop:
    """The loop from where the left foot begins to stand; as it is if it does not do so once."""
    shown = seen(loop.motion)
    pair = left_and_right(loop.motion.skeleton, shown.legs)
    if pair is None:
        return loop
    stands = steps_of(shown, len(loop.motion)).standing[:, pair[0]]
    begins = np.flatnonzero(stands & ~np.roll(stands, 1))
    if len(begins) != 1:
        return loop
    return replace(loop, motion=rolled(loop.motion, int(begins[0])), begun=True)


def rolled(motion: rl.Motion, frames: int) -> rl.Motion:
    return continued(motion, frames)[frames:] if frames else motion


# Faults --------------------------------------------------------------------------------------


def too_many(loop: Loop, strength: float) -> rl.Motion:
    return continued(loop.motion, int(strength) + int(loop.wraps))


def missing(loop: Loop, strength: float) -> rl.Motion:
    return in_form(loop)[: -int(strength)]


def popped(loop: Loop, strength: float) -> rl.Motion:
    motion = loop.motion
    rng = np.random.default_rng(len(motion))
    axes = rng.normal(size=(motion.skeleton.n_joints, 3))
    axes[0] = 0.0
    joints = seen(motion).joints
    bends = np.linalg.norm(np.diff(joints, n=2, axis=0), axis=-1).max()
    little = 1e-3
    moved = seen(_turning(motion, little * axes)).joints[-1] - joints[-1]
    angle = little * strength * bends / np.linalg.norm(moved, axis=-1).max()
    return in_form(loop, _turning(motion, angle * axes))


def _turning(motion: rl.Motion, vectors: np.ndarray) -> rl.Motion:
    share = np.linspace(0.0, 1.0, len(motion))[:, None, None]
    turns = rot.from_rotation_vector(share * vectors)
    return replace(motion, rotations=rot.multiply(motion.rotations, turns))


def sliding(loop: Loop, strength: float) -> rl.Motion | None:
    motion, size = loop.motion, loop.motion.skeleton.size
    if not steps_of(seen(motion), len(motion)).standing.any():
        return None
    way = (motion.root_path[-1] - motion.root_path[0]) * (1.0 - motion.up_vector)
    length = float(np.linalg.norm(way))
    ahead = way / length if length > 0.1 * size else np.eye(3)[(motion.up + 1) % 3]
    seconds = np.arange(len(motion))[:, None] * motion.frame_time
    return in_form(
        loop, replace(motion, root_path=motion.root_path + strength * size * seconds * ahead)
    )


def climbing(loop: Loop, strength: float) -> rl.Motion:
    form = in_form(loop)
    share = np.arange(len(form))[:, None] / len(loop.motion)
    climb = strength * form.skeleton.size * share * form.up_vector
    return replace(form, root_path=form.root_path + climb)


def slow(loop: Loop, strength: float) -> rl.Motion | None:
    form = in_form(loop)
    return replace(form, frame_time=form.frame_time * strength) if loop.gait else None


def scaled(loop: Loop, strength: float) -> rl.Motion | None:
    factor = strength if len(loop.motion) % 2 else 1.0 / strength
    return in_form(loop).scaled(factor) if loop.wraps else None


def bobbing(loop: Loop, strength: float) -> rl.Motion:
    """On a root bone put on the ground, which moves along with the hips."""
    form = in_form(loop)
    skeleton, up, size = form.skeleton, form.up_vector, form.skeleton.size
    names = ("ground", *(f"{name}_" if name == "ground" else name for name in skeleton.names))
    parents = (-1, *(parent + 1 for parent in skeleton.parents))
    lowest = float((form.positions() @ up).min())
    bob = 0.5 * strength * size * np.sin(4 * np.pi * np.arange(len(form)) / len(loop.motion))
    path = form.root_path * (1.0 - up) + (lowest + bob)[:, None] * up
    places = np.tile(np.vstack([np.zeros((1, 3)), skeleton.offsets]), (len(form), 1, 1))
    if form.translations is not None:
        places[:, 1:] = form.translations
    places[:, 1] = form.root_path - path
    ends = tuple((joint + 1, offset) for joint, offset in skeleton.end_sites)
    made = Skeleton(names, parents, places.mean(axis=0), ends)
    ahead = rot.from_rotation_vector(body_path(form)[1][:, None] * up)
    places[:, 1] = rot.rotate(rot.conjugate(ahead), places[:, 1])
    turns = np.concatenate([ahead[:, None], form.rotations], axis=1)
    turns[:, 1] = rot.multiply(rot.conjugate(ahead), turns[:, 1])
    return replace(form, skeleton=made, rotations=turns, root_path=path, translations=places)


def late(loop: Loop, strength: float) -> rl.Motion | None:
    if loop.phase is None:
        return None
    frames = round(strength * len(loop.motion))
    return in_form(loop, rolled(loop.motion, frames))


def in_form(loop: Loop, motion: rl.Motion | None = None) -> rl.Motion:
    """The frames as they stand in the loop's file."""
    motion = loop.motion if motion is None else motion
    return continued(motion, 1) if loop.wraps else motion


FAULTS: dict[str, tuple[Faulty, tuple[float, float, float]]] = {
    "frame too many": (too_many, (1, 2, 3)),
    "frame missing": (missing, (1, 2, 3)),
    "pop": (popped, (3, 6, 12)),
    "foot slide": (sliding, (0.15, 0.3, 0.6)),
    "drift": (climbing, (0.04, 0.08, 0.16)),
    "rate": (slow, (3, 4, 5)),
    "unit": (scaled, (10, 39.37, 100)),
    "root bob": (bobbing, (0.01, 0.02, 0.04)),
    "phase": (late, (0.2, 0.3, 0.5)),
}


# Figures -------------------------------------------------------------------------------------


def judged(loop: Loop) -> dict[str, Any]:
    """What is found in a loop as it is, and with each fault at each strength."""
    clean = [fault.name for fault in lint(in_form(loop), loop.wraps, loop.phase)]
    steady = [fault.name for fault in lint(bobbing(loop, 0.0), loop.wraps, loop.phase)]
    row: dict[str, Any] = {"name": loop.name, "source": loop.source, "gait": loop.gait}
    row |= {"clean": clean, "on_a_ground_bone": steady, "found": {}, "left": {}}
    for name, (put, strengths) in FAULTS.items():
        made = [put(loop, strength) for strength in strengths]
        found = [motion and _names(motion, loop) for motion in made]
        row["found"][name] = [names and name in names for names in found]
        if name in ("frame too many", "frame missing", "pop", "drift"):
            row["left"][name] = [
                name in _names(mended(motion, loop.wraps), loop)
                for motion in made
                if motion is not None
            ]
    return row


def _names(motion: rl.Motion, loop: Loop) -> set[str]:
    return {fault.name for fault in lint(motion, loop.wraps, loop.phase)} or {"none"}


def halved(rows: list[dict[str, Any]]) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rows of every second source, and of the others."""
    sources = sorted({row["source"] for row in rows})
    chosen = set(sources[::2])
    return (
        [row for row in rows if row["source"] in chosen],
        [row for row in rows if row["source"] not in chosen],
    )


def figures(rows: list[dict[str, Any]]) -> dict[str, Any]:
    each = {name: list(_shares(rows, name)) for name in FAULTS}
    found = [x for row in rows for name in FAULTS for x in row["found"][name] if x is not None]
    left = [x for row in rows for many in row["left"].values() for x in many]
    alarms = Counter(name for row in rows for name in row["clean"])
    return {
        "loops": len(rows),
        "check_found": round(float(np.mean(found)), 4),
        "check_false": round(float(np.mean([bool(row["clean"]) for row in rows])), 4),
        "false_on_a_ground_bone": round(
            float(np.mean([bool(row["on_a_ground_bone"]) for row in rows])), 4
        ),
        "mended": round(1.0 - float(np.mean(left)), 4),
        "found": each,
        "false": dict(alarms),
    }


def _shares(rows: list[dict[str, Any]], name: str) -> Iterator[float | None]:
    """Of each strength, the share that is found."""
    for place in range(3):
        found = [row["found"][name][place] for row in rows]
        known = [x for x in found if x is not None]
        yield round(float(np.mean(known)), 4) if known else None


def table(result: dict[str, Any]) -> Iterator[str]:
    for half in ("chosen_on", "shown_on"):
        one = result[half]
        yield f"{half}: {one['loops']} loops, false {one['check_false']}, {one['false']}"
        for name, shares in one["found"].items():
            yield f"  {name:16s}" + "".join(f"{share!s:>8}" for share in shares)


if __name__ == "__main__":
    main()
