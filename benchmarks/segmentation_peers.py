"""Other programs' segmentations; runs by itself, in whatever Python holds them.

Usage: PYTHON segmentation_peers.py IN.npz OUT.json

IN holds one array of points (n, d) in radians a capture, at 120 frames a second. OUT gives for
each program the cuts, the seconds each capture took, and what a user must set; a program that
is not installed is left out. Every program gets points averaged to a rate at which it works
best, on principal axes; its parameters are the best of a few on these very captures, which
favours it.
"""

from __future__ import annotations

import json
import sys
import time
import warnings
from collections.abc import Callable

import numpy as np

# The best of 1, 2, 2.5, 3, 5; of 2, 4, 6, 8, 10, 16; of .1, .3, 1, 3, 10; of 10, 30.
NORMAL_BIC = 2.0
RBF_PENALTY = 6.0
GGS_LAMBDA = 0.3
GGS_MOST = 10


def main(source: str, target: str) -> None:
    warnings.simplefilter("ignore")
    captures = dict(np.load(source))
    peers = {}
    for name, (make, parameters) in PEERS.items():
        try:
            cut = make()
        except ImportError:
            continue
        cut(np.random.default_rng(0).normal(size=(1200, 4)))
        peers[name] = {"parameters": parameters, "cuts": {}, "seconds": {}}
        for capture, points in captures.items():
            started = time.perf_counter()
            cuts = sorted({int(frame) for frame in cut(points)})
            peers[name]["seconds"][capture] = time.perf_counter() - started
            peers[name]["cuts"][capture] = [c for c in cuts if 0 < c < len(points)]
    with open(target, "w") as file:
        json.dump(peers, file)


def prepared(points: np.ndarray, step: int, least: float) -> np.ndarray:
    """Average each `step` frames; keep principal axes with more than `least` radians."""
    blocks = points[: len(points) // step * step].reshape(-1, step, points.shape[1]).mean(axis=1)
    centred = blocks - blocks.mean(axis=0)
    variances, axes = np.linalg.eigh(centred.T @ centred / len(centred))
    return centred @ axes[:, variances > least**2]


def pelt_normal() -> Callable[[np.ndarray], list[int]]:
    import ruptures

    def cut(points: np.ndarray) -> list[int]:
        x = prepared(points, 10, 0.04)
        d = x.shape[1]
        penalty = NORMAL_BIC * (d + d * (d + 1) / 2) * np.log(len(x))
        search = ruptures.Pelt(model="normal", min_size=max(10, d + 1), jump=1).fit(x)
        return [10 * place for place in search.predict(pen=penalty)]

    return cut


def pelt_rbf() -> Callable[[np.ndarray], list[int]]:
    import ruptures

    def cut(points: np.ndarray) -> list[int]:
        search = ruptures.Pelt(model="rbf", min_size=10, jump=1).fit(prepared(points, 12, 0.04))
        return [12 * place for place in search.predict(pen=RBF_PENALTY)]

    return cut


def greedy_gaussian() -> Callable[[np.ndarray], list[int]]:
    from aeon.segmentation import GreedyGaussianSegmenter

    def cut(points: np.ndarray) -> list[int]:
        method = GreedyGaussianSegmenter(k_max=GGS_MOST, lamb=GGS_LAMBDA, random_state=0)
        labels = method.fit_predict(prepared(points, 10, 0.04), axis=0)
        return [10 * (place + 1) for place in np.flatnonzero(np.diff(labels)).tolist()]

    return cut


def clasp() -> Callable[[np.ndarray], list[int]]:
    from claspy.segmentation import BinaryClaSPSegmentation

    def cut(points: np.ndarray) -> list[int]:
        return [
            6 * int(place)
            for place in BinaryClaSPSegmentation().fit_predict(prepared(points, 6, 0.04))
        ]

    return cut


PEERS = {
    "ruptures Pelt normal": (pelt_normal, 2),
    "ruptures Pelt rbf": (pelt_rbf, 2),
    "GGS (aeon)": (greedy_gaussian, 2),
    "claspy": (clasp, 0),
}

if __name__ == "__main__":
    main(*sys.argv[1:])
