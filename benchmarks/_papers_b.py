"""Figures 1 to 9 of [B], with what there is of its captures, and its claim of dimensions."""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks.paper_tables import BARBIC, FIGURE_5, FIGURE_6, FIGURE_9
from benchmarks.segmentation_data import Capture, labelled, single_behaviours
from roundelay.output.figures import new_figure, save, strip
from roundelay.output.figures.palette import phase_colours
from roundelay.output.figures.style import dress
from roundelay.reproduction.matrices import mahalanobis_matrix, projection_error_matrix
from roundelay.segmentation import pooled, score, segment_channels
from roundelay.segmentation.features import joint_quaternions
from roundelay.segmentation.gmm import GMMOptions, gmm_labels
from roundelay.segmentation.pca import OnlinePCA, intrinsic_dimension
from roundelay.segmentation.ppca import OnlinePPCA, PPCAOptions

__all__ = ["dimensions", "figures"]

Array = NDArray[np.float64]
METHODS = ("pca-paper", "ppca-paper", "gmm-paper")
# Two of each behaviour, of captures that are there; [B]'s are walking, running, sitting down,
# forward jumping, climbing, arm stretching, punching.
PAIRS = {
    "walking": (("86_01", 100), ("86_01", 1400)),
    "jogging": (("13_30", 2000), ("14_06", 600)),
    "squats": (("13_30", 1500), ("14_06", 1150)),
    "jumping": (("86_01", 620), ("86_01", 850)),
    "knee raises": (("13_30", 950), ("14_06", 1800)),
    "arm circles": (("13_29", 1300), ("13_31", 2200)),
    "punching": (("86_01", 2100), ("86_01", 4200)),
}
LENGTH = 240
"""Frames of each."""
LABELLED = {
    "figures": "[B] figures 1 to 9",
    "dimensions": "[B] 3.1",
    "_figure_1": "[B] figure 1",
    "_figure_2": "[B] figure 2",
    "_figure_3": "[B] figure 3",
    "_figure_4": "[B] figure 4",
    "_figures_5_6": "[B] figures 5 and 6",
    "_figure_8": "[B] figure 8",
}


def figures(data: Path, out: Path) -> dict[str, Any]:
    """Draw figures 1 to 9; 86_01 is [B]'s own with all channels, 86_02, 07, 11 with four."""
    out.mkdir(parents=True, exist_ok=True)
    captures = labelled(data)
    own = next(each for each in captures if each.name == "86_01")
    assert own.motion is not None
    values = joint_quaternions(own.motion)
    motions = {each.name: each.motion for each in captures if each.motion is not None}
    made: dict[str, Any] = {}
    for number, work in {
        "B 1": lambda: _figure_1(values, own, out),
        "B 2": lambda: _figure_2(values, own, out),
        "B 3": lambda: _figure_3(values, own, out),
        "B 4": lambda: _figure_4(values, own, out),
        "B 5": lambda: _figures_5_6(motions, out, 5),
        "B 6": lambda: _figures_5_6(motions, out, 6),
        "B 7, 9": lambda: _figures_7_9(captures, out),
        "B 8": lambda: _figure_8(own, out),
    }.items():
        begun = time.process_time()
        told = work()
        seconds = round(time.process_time() - begun, 2)
        parts = told if number == "B 7, 9" else {number: told}
        made |= {key: {"made": True, **row, "seconds": seconds} for key, row in parts.items()}
    return made


def _windows(axes: Any, capture: Capture) -> None:
    for early, late in capture.truth.windows:
        axes.axvspan(early, late, color="0.85", lw=0)


def _figure_1(values: Array, own: Capture, out: Path) -> dict[str, Any]:
    """The derivative of the error where walking turns to jumping: [B] shows walking to running."""
    online = OnlinePCA(120.0)
    online.push(values[:1150])
    frames, growth, threshold = np.array(online.growth).T
    figure = new_figure(9.0, 3.6)
    axes = figure.subplots()
    _windows(axes, own)
    axes.plot(frames, growth, color="C0", label="d_i")
    axes.plot(frames, threshold, color="C3", lw=1.0, label="mean + 3 standard deviations")
    for cut in online.cuts:
        axes.axvline(cut, color="k")
    axes.set_xlim(0, 1150)
    axes.legend(frameon=False)
    dress(axes, f"86_01, walking to jumping: cuts {online.cuts}", x="frame", y="error's derivative")
    save(figure, out / "B_1.png")
    window = next((a, b) for a, b in own.truth.windows)
    inside = any(window[0] <= cut <= window[1] for cut in online.cuts)
    return {"rows": 0, "of": 1, "stand_in": ["86_01"], "cut_in_window": inside}


def _figure_2(values: Array, own: Capture, out: Path) -> dict[str, Any]:
    online = OnlinePPCA(120.0, PPCAOptions.paper())
    online.push(values)
    frames, distance = np.array(online.curve).T
    figure = new_figure(9.0, 3.6)
    axes = figure.subplots()
    _windows(axes, own)
    axes.plot(frames, distance, color="C0")
    for cut in online.cuts:
        axes.axvline(cut, color="k", lw=1.0)
    dress(axes, f"86_01: H, cuts {online.cuts}", x="frame K", y="H (root of eq. 10)")
    save(figure, out / "B_2.png")
    return {"rows": 0, "of": 1, "stand_in": ["86_01"]}


def _figure_3(values: Array, own: Capture, out: Path) -> dict[str, Any]:
    groups = [(0, 550, "walking"), (2000, 2450, "punching"), (3300, 4000, "leg kicking")]
    parts = [values[start:stop] for start, stop, _ in groups]
    whole = np.concatenate(parts)
    axes_of = np.linalg.svd(whole - whole.mean(axis=0), full_matrices=False)[2][:2]
    figure = new_figure(5.5, 4.5)
    axes = figure.subplots()
    for (_, _, name), part, colour in zip(groups, parts, phase_colours(3), strict=True):
        axes.scatter(*((part - whole.mean(axis=0)) @ axes_of.T).T, s=4, color=colour, label=name)
    axes.legend(frameon=False)
    dress(axes, f"{own.name}: groups of frames", x="first axis", y="second axis")
    save(figure, out / "B_3.png")
    return {"rows": 0, "of": 2, "stand_in": ["86_01: walking, punching, leg kicking"]}


def _figure_4(values: Array, own: Capture, out: Path) -> dict[str, Any]:
    """The clusters of [B]'s own capture: walks alike, punches alike."""
    options = GMMOptions()
    labels = gmm_labels(values, 120.0, options, np.random.default_rng(0))[0]
    figure = new_figure(9.0, 2.6)
    axes = figure.subplots()
    _windows(axes, own)
    axes.plot(labels + 1, color="C0")
    for _, stop, _ in own.truth.segments[:-1]:
        axes.axvline(stop, color="k", lw=0.8)
    axes.set_yticks([1, 2, 3, 4])
    dress(axes, "86_01: clusters of the mixture, k = 4", x="frame", y="cluster")
    save(figure, out / "B_4.png")
    main = [int(np.bincount(labels[a:b]).argmax()) for a, b, _ in own.truth.segments]
    alike = len({main[0], main[2], main[4]}) == 1 and main[3] == main[6] != main[0]
    return {"rows": 1, "of": 1, "clusters": main, "as_printed": alike}


def _figures_5_6(motions: dict[str, rl.Motion], out: Path, number: int) -> dict[str, Any]:
    """The matrices of seven behaviours, two of each: the diagonal and the like are smallest."""
    clouds = [
        joint_quaternions(motions[name])[start : start + LENGTH]
        for pair in PAIRS.values()
        for name, start in pair
    ]
    ours = projection_error_matrix(clouds) if number == 5 else mahalanobis_matrix(clouds)
    text = FIGURE_5 if number == 5 else FIGURE_6
    printed = np.array([line.split() for line in text.split("\n") if line], float)
    figure = new_figure(11.0, 5.0)
    for axes, matrix, title in zip(
        figure.subplots(1, 2), (printed, ours), ("printed", "ours, other captures"), strict=True
    ):
        axes.imshow(matrix, cmap="magma_r")
        for (row, column), value in np.ndenumerate(matrix):
            colour = "w" if value > 0.5 * matrix.max() else "k"
            axes.text(
                column, row, f"{value:.0f}", ha="center", va="center", fontsize=6, color=colour
            )
        axes.set_title(f"[B] figure {number}: {title}", loc="left", fontsize=10)
        axes.set_xticks(np.arange(14), [f"{kind[:6]} {x}" for kind in PAIRS for x in "ab"])
        axes.tick_params(axis="x", rotation=90, labelsize=7)
    save(figure, out / f"B_{number}.png")
    apart = np.abs(np.diagonal(ours) - np.diagonal(printed))
    return {
        "rows": 0,
        "of": 14,
        "stand_in": list(PAIRS),
        "deviation": round(float(apart.max()), 2) if number == 6 else None,
        "deviation_of": "the diagonal of figure 6, 7 everywhere" if number == 6 else None,
        "smallest_on_diagonal": _smallest(ours),
        "smallest_on_diagonal_printed": _smallest(printed),
        "partner_second": _partners(ours),
        "partner_second_printed": _partners(printed),
    }


def _smallest(matrix: Array) -> int:
    """Rows whose least element is on the diagonal."""
    return int(np.sum(np.argmin(matrix, axis=1) == np.arange(len(matrix))))


def _partners(matrix: Array) -> int:
    """Rows in which the other of the same kind is nearest of all others."""
    rest = matrix + np.diag(np.full(len(matrix), np.inf))
    return int(np.sum(np.argmin(rest, axis=1) == (np.arange(len(matrix)) ^ 1)))


def _figures_7_9(captures: Sequence[Capture], out: Path) -> dict[str, Any]:
    """People's windows and the cuts of the three methods; precision and recall."""
    figure = new_figure(13.0, 1.5 * len(captures))
    scores: dict[str, list[Any]] = {name: [] for name in METHODS}
    for axes, capture in zip(figure.subplots(len(captures), 1), captures, strict=True):
        _windows(axes, capture)
        for row, name in enumerate(METHODS):
            cuts = _cuts(capture, name)
            scores[name].append((capture, score(cuts, capture.truth).strict))
            for cut in cuts:
                axes.plot([cut, cut], [row + 0.1, row + 0.9], color=f"C{row}", lw=2.0)
        axes.set_xlim(0, len(capture.values))
        dress(axes, capture.name, x="frame" if capture is captures[-1] else "", y=" ")
        axes.set_yticks([0.5, 1.5, 2.5], METHODS)
    save(figure, out / "B_7.png")
    theirs = [each for each in captures if each.name.startswith("86_")]
    table = {name: _precision_recall(scores[name]) for name in METHODS}
    printed = {name: list(FIGURE_9[name]) for name in METHODS}
    apart = [
        abs(a - b)
        for name in METHODS
        for a, b in zip(table[name]["all channels"], printed[name], strict=True)
    ]
    _draw_scores(table, printed, out / "B_9.png")
    return {
        "B 7": {"rows": len(theirs), "of": len(BARBIC)},
        "B 9": {
            "rows": len(theirs),
            "of": len(BARBIC),
            "deviation": round(max(apart), 3),
            "deviation_of": "precision and recall, on the five captures with all channels",
            "ours": table,
            "printed": printed,
        },
    }


def _cuts(capture: Capture, name: str) -> list[int]:
    with warnings.catch_warnings():
        # Of four channels R does not fit; that is shown.
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        if capture.motion is not None:
            return list(rl.segment(capture.motion, method=name).cuts)
        return list(segment_channels(capture.values, capture.fps, method=name).cuts)


def _precision_recall(scores: list[tuple[Capture, Any]]) -> dict[str, list[float]]:
    groups = {
        "all": scores,
        "all channels": [each for each in scores if each[0].motion is not None],
        "[B]'s own": [each for each in scores if each[0].name.startswith("86_")],
    }
    found = {}
    for key, chosen in groups.items():
        total = pooled([one for _, one in chosen])
        found[key] = [round(total.precision, 3), round(total.recall, 3)]
    return found


def _draw_scores(table: dict[str, Any], printed: dict[str, Any], path: Path) -> None:
    figure = new_figure(6.5, 3.2)
    axes = figure.subplots()
    place = np.arange(len(METHODS))
    for offset, (label, at, of) in enumerate(
        (
            ("precision, printed", 0, printed),
            ("precision, ours", 0, table),
            ("recall, printed", 1, printed),
            ("recall, ours", 1, table),
        )
    ):
        rows = [of[n] if of is printed else of[n]["all channels"] for n in METHODS]
        axes.bar(place + 0.2 * offset - 0.3, [row[at] for row in rows], 0.18, label=label)
    axes.set_xticks(place, METHODS)
    axes.legend(frameon=False, fontsize=7, ncols=2)
    dress(axes, "[B] figure 9", x=" ", y="share")
    axes.set_ylim(0.0, 1.3)
    save(figure, path)


def _figure_8(own: Capture, out: Path) -> dict[str, Any]:
    """A strip a segment of [B]'s own capture."""
    assert own.motion is not None
    for number, (start, stop, name) in enumerate(own.truth.segments, 1):
        picture = strip(own.motion[start:stop], poses=7)
        picture.suptitle(f"{number}: {name}", fontsize=10)
        save(picture, out / f"B_8_{number}.png", dpi=45)
    return {"rows": len(own.truth.segments), "of": 7}


def dimensions(data: Path) -> dict[str, Any]:
    """Tell in what share of named behaviours six dimensions hold .9 of the variance ([B] 3.1)."""
    ranks = []
    for capture in labelled(data):
        if capture.motion is not None:
            values = joint_quaternions(capture.motion)
            ranks += [_rank(values[start:stop]) for start, stop, _ in capture.truth.segments]
    ranks += [_rank(joint_quaternions(motion)) for motion in single_behaviours(data)]
    names = json.loads((data / "labels" / "barbic2004.json").read_text())["sequences"]["86_01"]
    return {
        "behaviours": len(ranks),
        "share": round(float(np.mean(np.array(ranks) <= 6)), 3),
        "printed": 0.85,
        "of_86_01": ranks[: len(names["segments"])],
    }


def _rank(values: Array) -> int:
    squares = np.linalg.svd(values - values.mean(axis=0), compute_uv=False) ** 2
    return intrinsic_dimension(squares, 0.9)
