"""What is told frame by frame: phases of takes, how soon who was lost is found, false periods."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._truth_data import captures, random_motion, random_takes
from roundelay import synth
from roundelay.cycles.edit.align import align

Array = NDArray[np.float64]

# Takes of one person each, walking or running.
PERSONS = (
    tuple(f"truth/cmu/35_{number}.bvh" for number in ("04", "10", "12", "32", "34")),
    tuple(f"cmu/bvh/35_{number}.bvh" for number in (18, 19, 20, 22, 24)),
    tuple(f"cmu/bvh/12_0{number}.bvh" for number in (1, 2, 3)),
    tuple(f"cmu/bvh/07_{number}.bvh" for number in ("01", "12")),
    tuple(
        f"truth/snu/walk_{name}.bvh"
        for name in (*(f"normal_style_{n}" for n in (2, 3, 4)), "slow_stright", "normal_left_180")
    ),
    tuple(
        f"truth/bandai2/dataset-2_walk_{name}.bvh"
        for name in ("feminine_008", "feminine_016", "active_024", "exhausted_021")
    ),
)
# Made walks: seeds of persons, paces over the usual one.
SEEDS, PACES = (1, 2, 3), (0.8, 1.0, 1.3)
FALSE_SEEDS, RESTARTS = 6, 12


def tracked_takes(data: Path) -> Iterator[dict[str, Any]]:
    """Follow each take by its own cycle and by those of the person's other takes.

    The truth is the offline phase of the take; that of another take's cycle differs from it by
    what aligns both.
    """
    for files in PERSONS:
        known = [(file, *_known(data / file)) for file in files]
        for file, motion, cycle in known:
            yield _row("same", file, file, _off(cycle, motion, cycle, 0.0))
        for (one, _, cycle), (other, motion, own) in permutations(known, 2):
            begins = -align(cycle, own).offset
            yield _row("other", one, other, _off(cycle, motion, own, begins))


def _known(path: Path) -> tuple[rl.Motion, rl.Cycle]:
    motion = rl.read(path)
    return motion, rl.find_cycles(motion)[0]


def _off(cycle: rl.Cycle, motion: rl.Motion, own: rl.Cycle, begins: float) -> Array:
    """Return by how many turns the phase is off, from a period after each stretch begins."""
    assert own.phase is not None
    assert own.evidence is not None
    told = rl.PhaseTracker(cycle, fps=motion.fps).follow(motion)
    away = (np.array([one.phase for one in told]) - own.phase - begins + 0.5) % 1.0 - 0.5
    for start, _ in own.evidence.runs:
        away[start : start + round(own.period * motion.fps)] = np.nan
    return np.asarray(away[np.isfinite(away)])


def _row(kind: str, one: str, other: str, off: Array) -> dict[str, Any]:
    rms = round(float(np.sqrt(np.mean(off**2))), 4) if len(off) else None
    return {"kind": kind, "cycle": one, "take": other, "frames": len(off), "rms": rms}


def tracked_walks() -> Iterator[dict[str, Any]]:
    """Follow made walks whose phase is known: of the same person, and of another."""
    for seed in SEEDS:
        made = synth.gait("walk", repetitions=6, rng=seed)
        cycle = rl.find_cycles(made.motion)[0]
        begins = float(np.angle(np.nanmean(np.exp(2j * np.pi * (cycle.phase - made.phase)))))
        for pace in PACES:
            for kind, person in (("same", seed), ("other", seed + 10)):
                walk = synth.gait(
                    "walk", repetitions=10, period=pace * made.period, noise=0.02, rng=person
                )
                told = rl.PhaseTracker(cycle).follow(walk.motion)
                away = np.array([one.phase for one in told]) - walk.phase - begins / (2 * np.pi)
                away = ((away + 0.5) % 1.0 - 0.5)[round(walk.period * 120) :]
                yield _row(kind, f"made {seed}", f"made {person}, pace {pace}", away)


def found_again() -> Iterator[dict[str, Any]]:
    """Follow a walk, random motion and the walk from another phase on: when is it found for good?

    In periods; within .05 turns, and told so.
    """
    first = synth.gait("walk", repetitions=6, rng=1)
    cycle = rl.find_cycles(first.motion)[0]
    begins = float(np.angle(np.nanmean(np.exp(2j * np.pi * (cycle.phase - first.phase)))))
    for number in range(RESTARTS):
        tracker = rl.PhaseTracker(cycle)
        tracker.follow(synth.gait("walk", repetitions=3, rng=1).motion)
        tracker.follow(synth.wander(3.0, rng=number).motion)
        again = synth.gait("walk", repetitions=5, start=number / RESTARTS, noise=0.01, rng=1)
        told = tracker.follow(again.motion)
        away = np.array([one.phase for one in told]) - again.phase - begins / (2 * np.pi)
        right = (np.abs((away + 0.5) % 1.0 - 0.5) < 0.05) & np.array([one.found for one in told])
        wrong = np.flatnonzero(~right)
        frames = int(wrong[-1]) + 1 if len(wrong) else 0
        yield {
            "start": round(number / RESTARTS, 3),
            "periods": round(frames / again.period / 120, 3),
        }


def microseconds() -> float:
    """Return the processor time of a frame of 31 joints, the least of some passes."""
    motion = synth.gait("walk", repetitions=6).motion
    tracker = rl.PhaseTracker(rl.find_cycles(motion)[0])
    passes = []
    for _ in range(20):
        start = process_time()
        for rotations in motion.rotations:
            tracker.frame(rotations)
        passes.append((process_time() - start) / len(motion))
    return round(1e6 * min(passes), 1)


def false_periods() -> dict[str, float]:
    """Count what the finder tells of random motion, and the minutes of it."""
    takes = [
        random_motion(one)
        for one in random_takes(FALSE_SEEDS)
        if one.joints == 20 and one.seconds == 300 and one.seed >= 2
    ]
    takes += [synth.wander(60.0, fps=60.0, rng=seed).motion for seed in range(FALSE_SEEDS)]
    told = sum(len(_announced(take)) for take in takes)
    return {"told": told, "minutes": round(sum(len(one) / one.fps for one in takes) / 60.0, 1)}


def periods_told(folder: Path) -> Iterator[dict[str, Any]]:
    """Tell after how many periods the finder tells that of each take of one gait."""
    for one in captures(folder):
        if one.period is None or one.frames < 4 * one.period * one.fps:
            continue
        told = _announced(rl.read(folder / one.file))
        yield {
            "capture": one.file,
            "after": round(told[0][0] / one.period, 2) if told else None,
            "period": round(told[0][1] / one.period, 3) if told else None,
        }


def _announced(motion: rl.Motion) -> list[tuple[float, float]]:
    """Return the seconds at which a period is told anew, and each period."""
    finder, before = rl.PeriodFinder(motion.skeleton, motion.fps), None
    told = []
    for number, rotations in enumerate(motion.rotations):
        found = finder.frame(rotations)
        if found is not None and before is None:
            told.append((number / motion.fps, found.period))
        before = found
    return told
