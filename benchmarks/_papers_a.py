"""Table 1 and figures 7 to 11 of [A], with what there is of its captures."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import roundelay as rl
from benchmarks.paper_a_data import ROWS
from benchmarks.paper_tables import TABLE_1
from benchmarks.raunio import find_capture
from roundelay.output.figures import excitations as draw_excitations
from roundelay.output.figures import new_figure
from roundelay.output.figures.palette import phase_colours
from roundelay.output.figures.style import dress
from roundelay.reproduction.cohomology import typical_trajectory
from roundelay.reproduction.configuration import configuration
from roundelay.reproduction.options import TrajectoryOptions
from roundelay.reproduction.rows import trajectory_row

__all__ = ["captions", "figures", "joined", "table_1"]

METRICS = ("euclidean", "variance", "adjacent")
ASKED = {
    "01_09": ("walking", "climbing", "dangling feet"),
    "02_07": ("slashes",),
    "05_13": ("balance", "first pirouette", "second pirouette"),
    "13_29": ("punching",),
    "143_23": ("punches",),
}
"""Behaviours that captions and text of [A] tell of."""
IN_PAPER = {
    "01_09": ("walking", "dangling feet"),
    "02_07": ("slashes",),
    "05_13": ("balance", "first pirouette"),
    "13_29": ("punching",),
    "143_23": ("punches",),
}
"""Of these, those of which [A] says that a coordinate picks them out."""
FIGURES = {"A 7": "143_23", "A 9": "01_09", "A 10": "02_07", "A 11": "05_13"}
HALF = 0.5
LABELLED = {
    "table_1": "[A] table 1",
    "figures": "[A] figures 7 to 11",
    "_figure_8": "[A] figure 8",
    "_literal": "[A] 4.2 to the letter",
}


def capture(data: Path, name: str) -> rl.Motion | None:
    """Read a capture if it is there."""
    try:
        return find_capture(data, name)
    except FileNotFoundError:
        return None


def table_1(data: Path) -> dict[str, Any]:
    """Measure the rows of table 1 that are there, as printed."""
    rows = []
    for printed in TABLE_1:
        motion = capture(data, printed.trial)
        if motion is None:
            continue
        options = TrajectoryOptions(scale=printed.end, dimensions=printed.dimensions)
        ours = trajectory_row(motion[slice(*printed.frames)], options)
        rows.append({"capture": printed.trial, "printed": _printed(printed), "ours": ours})
    apart = [_apart(row, "simplices") for row in rows]
    return {
        "made": bool(rows),
        "rows": len(rows),
        "of": len(TABLE_1),
        "deviation": max(apart, default=None),
        "deviation_of": "simplices, as a share of the printed number",
        "within_2_percent": sum(each < 0.02 for each in apart),
        "born_apart": {row["capture"]: round(_born(row), 2) for row in rows},
        "table": rows,
    }


def _printed(row: Any) -> dict[str, Any]:
    return {
        "born": row.born,
        "end": row.end,
        "dimensions": row.dimensions,
        "simplices": row.simplices,
        "cohomology_seconds": row.cohomology,
        "processing_seconds": row.processing,
        "frames_a_second": row.frames_a_second,
    }


def _apart(row: dict[str, Any], key: str) -> float:
    printed = row["printed"][key]
    return abs(row["ours"][key] - printed) / printed if key in row["ours"] else 1.0


def _born(row: dict[str, Any]) -> float:
    return row["ours"].get("born", np.nan) - row["printed"]["born"]


def captions(data: Path) -> dict[str, Any]:
    """Tell of each captioned behaviour who finds it: the default, and classes by each metric."""
    found = {}
    for name, asked in ASKED.items():
        motion = capture(data, name)
        if motion is None:
            continue
        motion = motion[slice(*ROWS[name].frames)]
        ranges = _ranges(name, len(motion))
        by = {"default": _by_default(motion, ranges)}
        for metric in METRICS:
            by[metric] = _by_classes(motion, metric, ranges)
        found[name] = {one: [who for who, told in by.items() if one in told] for one in asked}
    return found


def _ranges(name: str, frames: int) -> dict[str, list[list[tuple[int, int]]]]:
    """Frames of each behaviour; of slashes any one counts, and where none are told all do."""
    told = ROWS[name].behaviours
    if name == "02_07":
        return {"slashes": [list(parts) for parts in told.values()]}
    if not told:
        return {one: [[(0, frames)]] for one in ASKED[name]}
    return {one: [list(parts)] for one, parts in told.items()}


def _by_default(motion: rl.Motion, ranges: dict[str, Any]) -> set[str]:
    """Behaviours that one of the cycles lies in, by half of its frames."""
    try:
        runs = [c.evidence.runs for c in rl.find_cycles(motion) if c.evidence is not None]
    except rl.NoPeriod:
        return set()
    return {
        one
        for one, places in ranges.items()
        for parts in places
        for run in runs
        if _inside(run.frames, parts, len(motion)).mean() >= HALF
    }


def _by_classes(motion: rl.Motion, metric: Any, ranges: dict[str, Any]) -> set[str]:
    """Behaviours in which some class has half of its turning."""
    cloud = rl.point_cloud(motion.with_root_motion())
    found = rl.excitations(cloud, motion.fps, metric=metric)
    told = set()
    for each in found.classes:
        moved, active = np.abs(np.diff(each.turns, prepend=each.turns[0])), np.zeros(len(cloud))
        for region in each.regions:
            active[region.start : region.stop] = 1.0
        weight = moved * active
        for one, places in ranges.items():
            for parts in places:
                inside = _inside(np.arange(len(cloud)), parts, len(cloud))
                if weight.sum() > 0.0 and weight[inside].sum() >= HALF * weight.sum():
                    told.add(one)
    return told


def _inside(frames: Any, parts: list[tuple[int, int]], count: int) -> Any:
    mask = np.zeros(count, bool)
    for start, stop in parts:
        mask[start:stop] = True
    return mask[frames]


def joined(data: Path) -> dict[str, Any]:
    """Tell of the loops of 02_07 which slashes they join, and what their mean cycle leaves."""
    motion = capture(data, "02_07")
    if motion is None:
        return {"loops": []}
    points, rows = rl.point_cloud(motion), []
    for cycle in rl.find_cycles(motion):
        assert cycle.evidence is not None
        assert cycle.phase is not None
        frames = cycle.evidence.runs.frames
        passed = [
            name
            for name, parts in ROWS["02_07"].behaviours.items()
            if _inside(frames, list(parts), len(motion)).sum() > HALF * (parts[0][1] - parts[0][0])
        ]
        own, cells = points[frames], np.floor(cycle.phase[frames] % 1.0 * 48).astype(int)
        means = {cell: own[cells == cell].mean(axis=0) for cell in np.unique(cells)}
        apart = own - np.array([means[cell] for cell in cells])
        left = float(np.sum(apart**2) / np.sum((own - own.mean(axis=0)) ** 2))
        rows.append({"slashes": passed, "left": round(left, 3)})
    return {"loops": rows, "most_left": max((row["left"] for row in rows), default=0.0)}


def figures(data: Path, out: Path) -> dict[str, Any]:
    """Draw figures 7 to 11."""
    made: dict[str, Any] = {}
    for number, name in FIGURES.items():
        begun, motion = time.process_time(), capture(data, name)
        if motion is None:
            made[number] = {"made": False, "rows": 0, "of": 1}
            continue
        motion = motion[slice(*ROWS[name].frames)]
        _literal(motion, name, out / f"{number.replace(' ', '_')}_letter.png")
        metric = "variance" if number == "A 7" else "euclidean"
        found = rl.excitations(rl.point_cloud(motion.with_root_motion()), motion.fps, metric=metric)
        _save(draw_excitations(motion, found), out / f"{number.replace(' ', '_')}.png")
        made[number] = {"made": True, "rows": 1, "of": 1, "seconds": _since(begun)}
    begun = time.process_time()
    made["A 8"] = _figure_8(data, out) | {"seconds": _since(begun)}
    return made


def _literal(motion: rl.Motion, name: str, path: Path) -> None:
    """Draw the coordinates of the five longest bars, as [A] has them, with the caption's frames."""
    from roundelay.phase.unwrap import unwrap
    from roundelay.topology.coordinate import circular_coordinate

    printed = next(row for row in TABLE_1 if row.trial == name)
    options = TrajectoryOptions(scale=printed.end, dimensions=printed.dimensions)
    try:
        barcode = typical_trajectory(configuration(motion), options).barcode
    except rl.TooShort:
        return
    count = min(5, len(barcode))
    figure = new_figure(13.0, 1.3 * count)
    axes = np.atleast_1d(figure.subplots(count, 1, sharex=True))
    for k, (one, colour) in enumerate(zip(axes, phase_colours(count), strict=True)):
        at = float(np.nextafter(np.float32(barcode.deaths[k]), np.float32(0.0)))
        coordinate = circular_coordinate(barcode, k=k, scale=at, weights="uniform")
        one.plot(unwrap(coordinate.phase, [(0, len(coordinate.phase))]), color=colour)
        bar = f"class {k}: {barcode.births[k]:.1f} to {barcode.deaths[k]:.1f}"
        dress(one, bar, x="frame" if k == count - 1 else "", y="turns")
        for parts in ROWS[name].behaviours.values():
            for start, _ in parts:
                one.axvline(start, color="0.8", lw=0.8, zorder=0)
    _save(figure, path)


def _figure_8(data: Path, out: Path) -> dict[str, Any]:
    """Draw three joined captures; its own are not there, so that others stand in."""
    own = [capture(data, name) for name in ("104_19", "143_01", "143_05")]
    there = [motion for motion in own if motion is not None]
    parts = there if len(there) == 3 else [find_capture(data, n) for n in ("07_01", "09_01")]
    if len(there) < 3:
        parts.append(find_capture(data, "86_01")[560:1060])
    first = parts[0]
    whole = rl.concatenate(
        [rl.Motion(first.skeleton, m.rotations, m.root_path, first.frame_time) for m in parts]
    )
    found = rl.excitations(rl.point_cloud(whole.with_root_motion()), whole.fps)
    figure = draw_excitations(whole, found)
    for place in np.cumsum([len(part) for part in parts])[:-1]:
        for axes in figure.axes[1:]:
            axes.axvline(place * whole.frame_time, color="0.4", lw=1.0)
    _save(figure, out / "A_8.png")
    return {
        "made": True,
        "rows": len(there),
        "of": 3,
        "stand_in": [] if len(there) == 3 else ["07_01", "09_01", "86_01 frames 560 to 1060"],
    }


def _since(begun: float) -> float:
    return round(time.process_time() - begun, 2)


def _save(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=70)
