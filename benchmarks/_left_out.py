"""What is left out and predicted: repetitions of a cycle, and styles of Bandai-Namco's captures."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._truth_data import captures
from roundelay import synth
from roundelay.cycles.edit.align import align
from roundelay.cycles.modes import Chosen, Fit, chosen_modes, curves

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Repetitions of a cycle whose modes are tried, and frames of the longest capture looked at.
FEWEST, LONGEST = 6, 6000
# Made walks of known ways, and how well their shares must be told by three modes.
MADE, REPETITIONS, TOLD = 12, 14, 0.9
NAMED = re.compile(r"dataset-(\d)_(walk[a-z-]*|run|dash)_([a-z-]+)_\d+")
NEUTRAL = "normal"


def predicted(values: Array, early: Mask, chosen: Chosen, known: Array) -> Array:
    """Predict the late part of a new curve from its early part.

    Parameters
    ----------
    values : (R, D) ndarray
        Curves that modes are found from.
    early : (D,) ndarray of bool
    chosen : Chosen
        As by `chosen_modes` of the same curves; of none, the mean is predicted.
    known : (E,) ndarray
        The early values of the new one.
    """
    fit = Fit.of(values)
    away = np.zeros(values.shape[1])
    away[early] = known - fit.mean[early]
    told = fit.told(away, early, chosen.count) if chosen.count else 0.0
    return np.asarray(fit.mean[~early] + chosen.shrink * told)


def left_out_repetitions(folder: Path) -> Iterator[dict[str, Any]]:
    """Predict second halves of repetitions, each left out, by modes and by the mean of the others.

    The number of modes is chosen anew from the others alone, by leaving out one of them in turn.
    """
    for one in captures(folder):
        if one.frames > LONGEST or not (one.period or one.stretches):
            continue
        motion = rl.read(folder / one.file)
        for number, own in enumerate(_repetitions(motion)):
            if len(own) >= FEWEST:
                error, counts = _left_out(own)
                yield {
                    "capture": one.file,
                    "motion": number + 1,
                    "repetitions": len(own),
                    "modes": counts,
                    "error": round(error, 3),
                }


def _repetitions(motion: rl.Motion) -> Iterator[rl.Repetitions]:
    try:
        found = rl.find_cycles(motion)
    except rl.RoundelayError:
        return
    for cycle in found:
        try:
            yield rl.repetitions(cycle, motion)
        except rl.TooShort:
            continue


def _left_out(own: rl.Repetitions) -> tuple[float, list[int]]:
    """Return the squared error over that of the mean alone, and the numbers of modes chosen."""
    values, early = curves(own)
    by_mean, by_modes, counts = 0.0, 0.0, []
    for number, new in enumerate(values):
        others = np.delete(values, number, axis=0)
        chosen = chosen_modes(others, early)
        told = predicted(others, early, chosen, new[early])
        by_modes += float(np.sum((new[~early] - told) ** 2))
        by_mean += float(np.sum((new[~early] - others.mean(axis=0)[~early]) ** 2))
        counts.append(chosen.count)
    return by_modes / by_mean, counts


def known_ways() -> Iterator[dict[str, Any]]:
    """Compare the two ways in which repetitions of made walks differ with three modes found."""
    for seed in range(MADE):
        made = synth.varied(REPETITIONS, rng=seed)
        own = rl.repetitions(rl.find_cycles(made.motion)[0], made.motion)
        found = rl.modes(own)
        numbers = np.round(made.phase[np.round(own.starts).astype(int)]).astype(int)
        known = made.scores[numbers]
        table = np.column_stack([np.ones(len(own)), found.scores[:, :3]])
        fitted = table @ np.linalg.lstsq(table, known, rcond=None)[0]
        left = np.sum((known - fitted) ** 2, axis=0)
        told = 1.0 - left / np.sum((known - known.mean(axis=0)) ** 2, axis=0)
        yield {"seed": seed, "modes": found.count, "told": np.round(told, 3).tolist()}


def styles(folder: Path) -> Iterator[dict[str, Any]]:
    """Predict each capture of a content and style from the style as another content shows it.

    How far it then is from what was recorded, over how far the plain cycle of its content is.
    """
    cells = list(_cells(folder))
    for file, kind, style, cycle in cells:
        ratios: list[float] = []
        if style == NEUTRAL:
            continue
        for plain in _of(cells, kind, NEUTRAL):
            away = align(plain, cycle).distance
            for other, styled in _other_contents(cells, kind, style):
                ratios += [
                    align(rl.style(styled, neutral).on(plain), cycle).distance / away
                    for neutral in _of(cells, other, NEUTRAL)
                ]
        if ratios:
            ratio = round(float(np.exp(np.mean(np.log(ratios)))), 3)
            yield {"capture": file, "predictions": len(ratios), "nearness": ratio}


Cell = tuple[str, tuple[str, str], str, rl.Cycle]


def _cells(folder: Path) -> Iterator[Cell]:
    """Yield files of walks and runs with (data set, content), style and cycle."""
    files = [*folder.glob("truth/bandai?/*.bvh"), *folder.glob("other/bandai_namco/*.bvh")]
    for path in sorted(files):
        if named := NAMED.match(path.stem):
            try:
                cycle = rl.find_cycles(rl.read(path))[0]
            except rl.RoundelayError:
                continue
            yield path.name, (named[1], named[2]), named[3], cycle


def _of(cells: Sequence[Cell], kind: tuple[str, str], style: str) -> list[rl.Cycle]:
    return [cycle for _, one, other, cycle in cells if (one, other) == (kind, style)]


def _other_contents(
    cells: Sequence[Cell], kind: tuple[str, str], style: str
) -> Iterator[tuple[tuple[str, str], rl.Cycle]]:
    for _, other, shown, cycle in cells:
        if other[0] == kind[0] and other != kind and shown == style:
            yield other, cycle
