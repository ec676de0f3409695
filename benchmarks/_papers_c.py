"""Tables A and B and figures 3.1, 3.4 and 4.2 of [C], with what there is of its captures."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks.harmonic import captures, load
from benchmarks.harmonic_metrics import errors
from benchmarks.raunio_tables import PUBLISHED, SCALE, Published
from roundelay.cycles.models.constrained import M1
from roundelay.output.figures import new_figure, save
from roundelay.output.figures.style import dress, phase_look
from roundelay.phase.harmonic import HarmonicCurve, design_matrix
from roundelay.phase.phase_map import rank_remap
from roundelay.reproduction.configuration import euler_angles
from roundelay.reproduction.options import ExtractionOptions
from roundelay.reproduction.raunio import PaperOptions, with_primes
from roundelay.reproduction.rows import extraction_rows
from roundelay.topology.coordinate import circular_coordinate
from roundelay.topology.rips import persistent_cohomology

__all__ = ["figures", "tables"]

TABLES = {"boxing": ("C A.1", "C B.1"), "walk": ("C A.2", "C B.2"), "run": ("C A.3", "C B.3")}
OTHERS = ("complete", "correlated", "ridge", "reweighted")
LABELLED = {
    "tables": "[C] tables A and B",
    "_row": "[C] M1, M2, M3",
    "figures": "[C] figures",
    "_figure_3_1": "[C] figure 3.1",
    "_figure_3_4": "[C] figure 3.4",
    "_figure_4_2": "[C] figure 4.2",
}


def tables(data: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Measure the rows that are there; the second is what else is told of them."""
    found = captures(data)
    made: dict[str, Any] = {}
    others: dict[str, Any] = {}
    for kind, (first, second) in TABLES.items():
        begun = time.process_time()
        printed = [row for row in PUBLISHED if row.kind == kind]
        rows = [_row(row, found[row.trial]) for row in printed if row.trial in found]
        seconds = round(time.process_time() - begun, 2)
        of = {"rows": len(rows), "of": len(printed), "made": bool(rows), "seconds": seconds}
        made[first] = of | _apart(rows, "template", "error", "template error of M1, radians")
        made[second] = of | _apart(rows, "rmse", "rmse", "RMSE of positions of M1, radians")
        others[kind] = _others(rows)
    return made, others


def _row(row: Published, path: Path) -> dict[str, Any]:
    motion = load(path, row.frames)
    ours = extraction_rows(motion, ExtractionOptions(scale=SCALE[row.kind]))
    printed = {
        "template": row.template[0],
        "rmse": row.m1_rmse[0],
        "periods": row.periods,
        "m2": row.template[1],
        "m3": row.template[2],
    }
    default = _default(row, path, motion) if row.frames is not None else None
    return {"capture": row.trial, "printed": printed, "ours": ours, "default": default}


def _default(row: Published, path: Path, window: rl.Motion) -> dict[str, Any]:
    """The template error of the default's loops against [C]'s window, in [C]'s channels.

    The loops are those of the whole capture: a window of one punch tells no period. Where the
    default finds none, the longest class of the window is followed, as [C] does.
    """
    by_hand = rl.Options(topology=rl.TopologyOptions(classes=1))
    best: dict[str, Any] = {}
    try:
        cycles = rl.find_cycles(load(path, None))
    except rl.NoPeriod:
        try:
            cycles = rl.find_cycles(window, by_hand)
        except rl.NoPeriod as refusal:
            return {"failed": str(refusal)}
        best = {"refused": True}
    for cycle in cycles:
        loop = cycle.sample(in_place=True, foot_lock=False).rotations
        error = errors(window, loop)["channels"]
        assert cycle.evidence is not None
        if error < best.get("error", np.inf):
            best["error"] = round(error, 3)
            best["frames"] = [list(x) for x in cycle.evidence.runs]
    return best


def _apart(rows: list[dict[str, Any]], key: str, own: str, words: str) -> dict[str, Any]:
    values = {}
    for row in rows:
        found = row["ours"]["M1"].get(own)
        if found is not None:
            found = found[0] if isinstance(found, list) else found
            values[row["capture"]] = found - row["printed"][key]
    sizes = np.abs(list(values.values()))
    worst = max(values, key=lambda name: abs(values[name]), default="")
    return {
        "deviation": round(float(sizes.max(initial=0.0)), 3),
        "deviation_of": words,
        "worst": worst,
        "median_deviation": round(float(np.median(sizes)), 3) if len(sizes) else None,
    }


def _others(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians of the template errors of M1 and what [C] discusses, and of the tests of spread."""
    told: dict[str, Any] = {
        name: _median([row["ours"][name].get("error") for row in rows])
        for name in ("M1", "M2", "M3", *OTHERS)
    }
    told["printed"] = _median([row["printed"]["template"] for row in rows])
    for when in ("before", "after"):
        shares = [row["ours"].get("spread", {}).get(when) for row in rows]
        told[f"unequal_{when}"] = _median(shares)
    told["default"] = {row["capture"]: row["default"] for row in rows if row["default"]}
    return told


def _median(values: list[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return round(float(np.median(known)), 3) if known else None


def figures(data: Path, out: Path) -> dict[str, Any]:
    """Draw figures 3.1, 3.4 and 4.2."""
    out.mkdir(parents=True, exist_ok=True)
    made = {}
    for number, work in {
        "C 3.1": lambda: _figure_3_1(out),
        "C 3.4": lambda: _figure_3_4(out),
        "C 4.2": lambda: _figure_4_2(data, out),
    }.items():
        begun = time.process_time()
        made[number] = {**work(), "seconds": round(time.process_time() - begun, 2)}
    return made


def _figure_3_1(out: Path) -> dict[str, Any]:
    """A circle, and one with a wave: points by coordinate, h of one harmonic and of ten."""
    rng = np.random.default_rng(0)
    angle = 2 * np.pi * rng.random(400)
    figure = new_figure(11.0, 6.6)
    axes = figure.subplots(2, 3)
    for row, wave in zip(axes, (0.0, 0.18), strict=True):
        radius = 1.0 + wave * np.sin(10 * angle)
        points = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        points += rng.normal(0.0, 0.02, points.shape)
        phase = circular_coordinate(persistent_cohomology(points), weights="uniform").phase
        row[0].scatter(*points.T, c=phase, s=6, **phase_look())
        for one, count in zip(row[1:], (1, 10), strict=True):
            solution = np.linalg.lstsq(design_matrix(phase, count), points, rcond=None)[0]
            curve = HarmonicCurve.from_solution(solution)(np.linspace(0.0, 1.0, 400))
            one.scatter(*points.T, color="0.8", s=4)
            one.plot(*curve.T, color="C0")
            dress(one, f"K = {count}", x=" ", y=" ")
        dress(row[0], "circular coordinate", x=" ", y=" ")
    for one in axes.flat:
        one.set_aspect("equal")
    save(figure, out / "C_3.1.png")
    return {"made": True, "rows": 1, "of": 1}


def _figure_3_4(out: Path) -> dict[str, Any]:
    """One period repeated exactly: ranks part what belongs together, in a zig-zag."""
    phase = np.tile(np.arange(40) / 40.0, 3)
    ranks = rank_remap(phase)
    figure = new_figure(11.0, 3.2)
    for axes, (values, title) in zip(
        figure.subplots(1, 3),
        (
            (phase, "the coordinate, three periods"),
            (ranks, "by ranks: neighbours in phase are parted"),
            (phase, "ideal: what belongs together overlaps"),
        ),
        strict=True,
    ):
        order = np.argsort(values, kind="stable")
        pose = np.sin(2 * np.pi * phase) + np.repeat([0.0, 0.15, -0.15], 40)
        if title.startswith("the"):
            axes.plot(values, ".", ms=3)
            dress(axes, title, x="frame", y="coordinate")
        elif title.startswith("by"):
            axes.plot(values[order], pose[order], ".-", ms=3, lw=0.8)
            dress(axes, title, x="coordinate", y="an angle")
        else:
            axes.plot(values.reshape(3, 40).T, pose.reshape(3, 40).T, ".-", ms=3, lw=0.8)
            dress(axes, title, x="coordinate", y="an angle")
    save(figure, out / "C_3.4.png")
    return {"made": True, "rows": 1, "of": 1}


def _figure_4_2(data: Path, out: Path) -> dict[str, Any]:
    """35_19 with all bones, and without the bone of the hand that jumps."""
    path = captures(data).get("35_19")
    if path is None:
        return {"made": False, "rows": 0, "of": 1}
    motion = load(path, None)
    angles = euler_angles(motion, motion.rotations)
    jumps = np.abs(np.diff(angles, axis=0)).max(axis=(0, 2))
    joint = int(np.argmax(jumps[1:])) + 1
    kept = np.arange(angles.shape[1]) != joint
    figure = new_figure(10.0, 4.6)
    told = {}
    for axes, (name, chosen) in zip(
        figure.subplots(1, 2),
        (("all bones", angles), (f"without {motion.skeleton.names[joint]}", angles[:, kept])),
        strict=True,
    ):
        values = chosen.reshape(len(motion), -1)
        found = with_primes(values, PaperOptions(scale=SCALE["run"], model=M1))
        plane = np.linalg.svd(values - values.mean(axis=0), full_matrices=False)[2][:2]
        own = values[: len(found.phase)] - values.mean(axis=0)
        axes.scatter(*(own @ plane.T).T, c=found.phase, s=8, **phase_look())
        dress(axes, f"{name}: {found.period_count:.2f} periods", x="first axis", y="second axis")
        told[name] = round(found.period_count, 2)
    save(figure, out / "C_4.2.png")
    return {"made": True, "rows": 1, "of": 1, "periods": told, "printed_periods": 1.0}
