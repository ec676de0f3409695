"""What a user gets of cuts and names, on takes whose behaviours are known."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks import _behaviour_takes as takes
from benchmarks._behaviour_takes import Take
from roundelay.geometry import rotations as rot
from roundelay.segmentation import Segmentation, Truth, pooled, score

TAKES = 8
# Of the default: what a finer answer keeps besides, a coarser one does not.
SENSITIVITIES = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
DRIFTS = (0.06, 0.12)
SOURCES = ("hdm05", "bandai", "clips")
JOINED = (*SOURCES, *(f"{source} {drift}" for drift in DRIFTS for source in ("made", *SOURCES)))
"""All kinds of joined takes: as they are, and with a posture that wanders."""
Pairs = tuple[int, int, int, int]


def measured(data: Path) -> dict[str, Any]:
    """Measure all that is asked of cuts and names on joined takes."""
    truth = data / "truth"
    joined = {
        "hdm05": takes.hdm_joins(truth, TAKES),
        "bandai": takes.bandai_joins(truth, TAKES),
        "clips": takes.clip_joins(truth, TAKES),
    }
    rows = {name: _joined(given) for name, given in joined.items()}
    for drift in DRIFTS:
        rows[f"made {drift}"] = _joined(takes.drifting_joins(drift, TAKES // 2))
        rows[f"hdm05 {drift}"] = _joined(takes.hdm_joins(truth, TAKES // 2, drift))
        rows[f"bandai {drift}"] = _joined(takes.bandai_joins(truth, TAKES // 2, drift))
        rows[f"clips {drift}"] = _joined(takes.clip_joins(truth, TAKES // 2, drift))
    single = list(takes.single_behaviours(truth).values())
    walks = list(takes.drifting_walks(DRIFTS, TAKES // 2))
    return {
        "joined": rows,
        "curve": _curve(single, joined["clips"]),
        "drifting_walks": _a_minute(walks, 1.0),
        "short": {f"{s:g} s": _short(truth, s) for s in (1.0, 1.5, 2.0)},
        "nested": _nested([take.motion for given in joined.values() for take in given]),
        "robust": _robust(truth / "lafan1"),
    }


def _joined(given: Sequence[Take]) -> dict[str, Any]:
    """Cuts within .5 s, frames whose label is right, and labels of what came back."""
    found = [rl.segment(take.motion) for take in given]
    scores = [score(one, take.truth) for one, take in zip(found, given, strict=True)]
    near = pooled([one.at(0.5) for one in scores])
    counts = [pairs(one, take.truth) for one, take in zip(found, given, strict=True)]
    same, of_same, different, of_different = np.sum(counts, axis=0).tolist()
    return {
        "half_second": round(near.f, 3),
        "precision": round(near.precision, 3),
        "recall": round(near.recall, 3),
        "labels": round(float(np.mean([one.label_accuracy for one in scores])), 3),
        "same": round(same / of_same, 3),
        "of_same": of_same,
        "different": round(different / of_different, 3),
        "of_different": of_different,
    }


def pairs(found: Segmentation, truth: Truth) -> Pairs:
    """Count pairs of parts of one behaviour: labelled alike, all; and of two: alike, all."""
    labels = [int(np.bincount(found.labels[a:b]).argmax()) for a, b, _ in truth.segments]
    named = list(zip(labels, [name for _, _, name in truth.segments], strict=True))
    same = [one[0] == other[0] for one, other in combinations(named, 2) if one[1] == other[1]]
    apart = [one[0] == other[0] for one, other in combinations(named, 2) if one[1] != other[1]]
    return sum(same), len(same), sum(apart), len(apart)


def _curve(single: Sequence[rl.Motion], joined: Sequence[Take]) -> list[dict[str, float]]:
    """False cuts a minute of clips of one behaviour, and recall on the same clips joined."""
    rows = []
    told = [rl.understand(take.motion) for take in joined]
    for sensitivity in SENSITIVITIES:
        found = [
            rl.segment(take.motion, sensitivity=sensitivity, timeline=timeline)
            for take, timeline in zip(joined, told, strict=True)
        ]
        near = pooled(
            [score(one, take.truth).at(0.5) for one, take in zip(found, joined, strict=True)]
        )
        rows.append(
            {
                "sensitivity": sensitivity,
                "false_a_minute": _a_minute(single, sensitivity),
                "recall": round(near.recall, 3),
                "precision": round(near.precision, 3),
            }
        )
    return rows


def _a_minute(motions: Sequence[rl.Motion], sensitivity: float) -> float:
    cuts = sum(len(rl.segment(motion, sensitivity=sensitivity).cuts) for motion in motions)
    return round(cuts / (sum(motion.duration for motion in motions) / 60.0), 3)


def _short(truth: Path, seconds: float) -> float:
    """Return the share of cuts between behaviours of a second or two found within .3 s."""
    hits = []
    for take in takes.short_joins(truth, seconds, TAKES):
        reach = round(0.3 * take.motion.fps)
        wider = tuple((first - reach, last + reach) for first, last in take.truth.windows)
        hits.append(score(rl.segment(take.motion), replace(take.truth, windows=wider)).strict)
    return round(pooled(hits).recall, 3)


def _nested(motions: Sequence[rl.Motion]) -> float:
    """Return the share of takes whose ten sections each hold all cuts of the coarser ones."""
    asked = [2.0**k for k in range(-5, 5)]
    whole = 0
    for motion in motions:
        told = rl.understand(motion)
        found = [rl.segment(motion, sensitivity=one, timeline=told) for one in asked]
        cuts = [set(one.cuts) for one in found]
        whole += all(one <= other for one, other in pairwise(cuts))
    return whole / len(motions)


def _robust(folder: Path) -> dict[str, float]:
    """Return the share of cuts that stay within .5 s under each change, the least of the takes."""
    kept: dict[str, list[float]] = {}
    for path in sorted(folder.glob("*.bvh")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            motion = rl.read(path)
        times = _times(motion)
        for name, change in CHANGES.items():
            found = np.sort(
                np.concatenate([start + _times(part) for start, part in change(motion)])
            )
            apart = [np.abs(found - time).min(initial=np.inf) for time in times]
            kept.setdefault(name, []).append(float(np.mean(np.array(apart) <= 0.5)))
    return {name: round(float(np.mean(shares)), 3) for name, shares in kept.items()}


def _times(motion: rl.Motion) -> np.ndarray:
    return np.array(rl.segment(motion).cuts, float) / motion.fps


Parts = list[tuple[float, rl.Motion]]


def _frozen(motion: rl.Motion) -> Parts:
    """Let an arm stand still for a third of the take."""
    names = motion.skeleton.names
    third, turned = len(motion) // 3, motion.rotations.copy()
    for name in ("LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"):
        turned[third : 2 * third, names.index(name)] = turned[third, names.index(name)]
    return [(0.0, replace(motion, rotations=turned))]


def _in_two(motion: rl.Motion) -> Parts:
    half = len(motion) // 2
    return [(0.0, motion[:half]), (half / motion.fps, motion[half:])]


def _noisy(motion: rl.Motion) -> Parts:
    """Noise of .05 rad on every joint but the root."""
    noise = np.random.default_rng(0).normal(0.0, 0.05, (*motion.rotations.shape[:2], 3))
    noise[:, 0] = 0.0
    turned = rot.multiply(motion.rotations, rot.from_rotation_vector(noise))
    return [(0.0, replace(motion, rotations=turned))]


def _glitches(motion: rl.Motion) -> Parts:
    """Turn a joint by two radians for one frame, forty times."""
    rng, turned = np.random.default_rng(0), motion.rotations.copy()
    for _ in range(40):
        frame, joint = rng.integers(len(motion)), rng.integers(1, motion.skeleton.n_joints)
        axis = rng.normal(size=3)
        turn = rot.from_rotation_vector(2.0 * axis / np.linalg.norm(axis))
        turned[frame, joint] = rot.multiply(turn, turned[frame, joint])
    return [(0.0, replace(motion, rotations=turned))]


CHANGES: dict[str, Callable[[rl.Motion], Parts]] = {
    "a limb frozen": _frozen,
    "in two files": _in_two,
    "24 fps": lambda motion: [(0.0, motion.resample(24.0))],
    "60 fps": lambda motion: [(0.0, motion.resample(60.0))],
    "240 fps": lambda motion: [(0.0, motion.resample(240.0))],
    "40 glitches": _glitches,
    "noise of .05 rad": _noisy,
}
