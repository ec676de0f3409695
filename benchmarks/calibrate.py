"""Fit the weights by which `rl.understand` turns the tests of a behaviour into a probability.

Usage: python -m benchmarks.calibrate --data FOLDER [--json] [--keep] [--write]

Behaviours of all captures below the folder are judged by the yardstick of `benchmarks.truth`:
right ones pass it. Behaviours found in smooth random motion are wrong, whatever the yardstick
says. A logistic regression of the named figures is fitted to all of them; for the figures of the
summary each source (the folder that holds a capture) is left out once. `--write` puts the weights
into the package, as ``timeline/calibration.json``.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._harness import ROOT, Target, parser, report
from benchmarks._truth_data import Random, random_motion
from benchmarks._yardstick import body, measured
from roundelay.timeline.assembly import candidates_of
from roundelay.timeline.calibration import figures_of, tests_of
from roundelay.timeline.thresholds import SEARCH

WEIGHTS = ROOT / "src" / "roundelay" / "timeline" / "calibration.json"
# What a behaviour of random motion counts for, and how strongly weights are drawn to 0.
RANDOM, RIDGE = 0.3, 1e-3
# Seconds of random motion, and how many takes of each kind.
LENGTHS = {10: 12, 30: 12, 300: 4}
BINS = (0.0, 0.2, 0.5, 0.8, 0.95, 1.0)
TARGETS = (
    Target("calibration_error", "<=", 0.05, "calibration error, each source left out"),
    Target("area", ">=", 0.9, "area under the curve, each source left out"),
)
Array = NDArray[np.float64]


def main() -> None:
    asked = parser(__doc__, data="folder of captures")
    asked.add_argument("--write", action="store_true", help="put the weights into the package")
    asked.add_argument("--jobs", type=int, default=2, help="processes")
    arguments = asked.parse_args()
    paths = [
        path
        for path in sorted(arguments.data.rglob("*"))
        if path.suffix in (".bvh", ".amc") and "odd" not in path.parts
    ]
    chances = [
        Random(synergies, joints, seconds, 1000 + seed)
        for synergies in (2, 3, 5, 8)
        for joints in (4, 20)
        for seconds, seeds in LENGTHS.items()
        for seed in range(seeds)
    ]
    with ProcessPoolExecutor(arguments.jobs) as pool:
        found = [row for rows in pool.map(_of_capture, paths, chunksize=4) for row in rows]
        chance = [row for rows in pool.map(_of_chance, chances, chunksize=2) for row in rows]
    names = list(found[0]["figures"])
    x, y = _columns(found, names), np.array([row["right"] for row in found], float)
    sources = np.array([row["source"] for row in found])
    noise = _columns(chance, names)
    fit = partial(_fitted, noise=noise)
    probability = np.zeros(len(y))
    for source in sorted(set(sources)):
        out = sources == source
        probability[out] = _probability(fit(x[~out], y[~out]), x[out])
    weights = dict(zip([*names, "constant"], np.round(fit(x, y), 4).tolist(), strict=True))
    if arguments.write:
        WEIGHTS.write_text(json.dumps({"weights": weights}, indent=1) + "\n")
    summary = {
        "behaviours": len(y),
        "of_random_motion": len(noise),
        "calibration_error": _error(probability, y),
        "area": _area(probability, y),
    }
    report("calibrate", {"summary": summary, "weights": weights}, TARGETS, arguments)


def _of_capture(path: Path) -> list[dict[str, Any]]:
    warnings.simplefilter("ignore")
    try:
        motion = rl.read(path)
    except rl.RoundelayError:
        return []
    seen = body(motion)
    if len(motion) < SEARCH.fewest:
        return []
    return [
        {
            "figures": figures,
            "right": measured(seen, joints, spans, period).passes,
            "source": path.parent.name if "acclaim" not in path.parts else "acclaim",
        }
        for figures, joints, spans, period in _judged(motion)
    ]


def _of_chance(take: Random) -> list[dict[str, Any]]:
    return [{"figures": figures} for figures, *_ in _judged(random_motion(take))]


def _judged(motion: rl.Motion) -> Iterator[tuple[dict[str, float], list[str], Any, float]]:
    """Figures, joints, frames and period in seconds of all that may repeat."""
    found, pieces = candidates_of(motion)
    for piece in pieces:
        spans = [(found.frames(a), found.frames(b)) for a, b in piece.runs]
        joints = [found.names[joint] for joint in found.joints(piece.claimed)]
        yield figures_of(piece, tests_of(found, piece)), joints, spans, piece.period / found.rate


def _columns(rows: list[dict[str, Any]], names: list[str]) -> Array:
    return np.array([[row["figures"][name] for name in names] for row in rows], float)


def _fitted(x: Array, y: Array, noise: Array) -> Array:
    """Fit by Newton's method, columns in units of their spread; the constant comes last."""
    middle, spread = x.mean(axis=0), x.std(axis=0) + 1e-9
    z = np.column_stack([(np.vstack([x, noise]) - middle) / spread, np.ones(len(x) + len(noise))])
    right = np.concatenate([y, np.zeros(len(noise))])
    share = np.concatenate([np.ones(len(y)), np.full(len(noise), RANDOM)])
    ridge = RIDGE * len(z) * np.diag([*np.ones(x.shape[1]), 0.0])
    weights = np.zeros(z.shape[1])
    for _ in range(60):
        p = 1.0 / (1.0 + np.exp(-np.clip(z @ weights, -30, 30)))
        slope = z.T @ (share * (p - right)) + ridge @ weights
        bend = (z * (share * p * (1 - p))[:, None]).T @ z + ridge + 1e-9 * np.eye(len(weights))
        weights = weights - np.linalg.solve(bend, slope)
    plain = weights[:-1] / spread
    return np.append(plain, weights[-1] - plain @ middle)


def _probability(weights: Array, x: Array) -> Array:
    return 1.0 / (1.0 + np.exp(-(x @ weights[:-1] + weights[-1])))


def _error(p: Array, y: Array) -> float:
    """Mean over bins of what is told from what is right."""
    places = np.digitize(p, BINS[1:-1])
    inside = [places == place for place in range(len(BINS) - 1) if np.any(places == place)]
    return float(sum(np.mean(own) * abs(p[own].mean() - y[own].mean()) for own in inside))


def _area(p: Array, y: Array) -> float:
    ranks = np.empty(len(p))
    ranks[np.argsort(p)] = np.arange(1, len(p) + 1)
    right, wrong = y.sum(), len(y) - y.sum()
    return float((ranks[y > 0].sum() - right * (right + 1) / 2) / (right * wrong))


if __name__ == "__main__":
    main()
