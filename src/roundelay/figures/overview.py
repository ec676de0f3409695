"""Pictures of results, with Matplotlib, which is imported only when one is drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from roundelay.files import written_beside
from roundelay.motion import Motion
from roundelay.poses import point_cloud

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from roundelay.cycles.cycle import Cycle
    from roundelay.periodicity import Evidence
    from roundelay.topology.rips import Barcode

__all__ = ["barcode", "coordinate", "new_figure", "overview", "plane", "save"]

_INK, _ACCENT, _PALE = "#33415c", "#d1495b", "#b8c0cc"
_PHASE_COLOURS = "twilight"
_MOST_BARS = 30


def barcode(axes: Axes, bars: Barcode, chosen: int = 0) -> None:
    """Draw degree-1 bars, the longest at the bottom, the chosen one in colour ([A] fig. 4)."""
    shown = min(len(bars), _MOST_BARS)
    for row in range(shown):
        colour = _ACCENT if row == chosen else _INK
        axes.plot([bars.births[row], bars.deaths[row]], [row, row], color=colour, lw=2.5)
    hidden = len(bars) - shown
    axes.set_title("barcode, degree 1" + (f" ({hidden} short bars not shown)" if hidden else ""))
    axes.set_xlabel("scale (body sizes)")
    axes.set_yticks([])
    axes.set_ylim(-1, max(shown, 3))


def coordinate(axes: Axes, evidence: Evidence, motion: Motion) -> None:
    """Draw the unwrapped circular coordinate of every periodic part over time ([C] fig. 3.7)."""
    seconds = np.arange(len(motion)) * motion.frame_time
    for start, stop in evidence.runs:
        axes.axvspan(seconds[start], seconds[stop - 1], color=_PALE, alpha=0.35, lw=0)
        turns = evidence.turns[start:stop]
        axes.scatter(
            seconds[start:stop], turns, c=turns % 1.0, cmap=_PHASE_COLOURS, s=5, vmin=0, vmax=1
        )
    axes.set_xlim(0.0, motion.duration)
    axes.set_title("circular coordinate, unwrapped")
    axes.set_xlabel("time (s)")
    axes.set_ylabel("turns")
    axes.grid(alpha=0.3)


def plane(axes: Axes, cycle: Cycle, motion: Motion) -> None:
    """Draw capture and cycle in the capture's first two principal components ([A] fig. 4)."""
    points = point_cloud(motion)
    evidence = cycle.evidence
    frames = np.arange(len(motion))
    if evidence is not None:
        frames = np.concatenate([np.arange(*run) for run in evidence.runs])
    centre = points[frames].mean(axis=0)
    axes_2d = np.linalg.svd(points[frames] - centre, full_matrices=False)[2][:2].T
    seen = (points - centre) @ axes_2d
    axes.plot(seen[:, 0], seen[:, 1], color=_PALE, lw=0.5, zorder=0)
    if evidence is not None:
        phase = evidence.turns[frames] % 1.0
        x, y = seen[frames].T
        axes.scatter(x, y, c=phase, cmap=_PHASE_COLOURS, s=5, vmin=0, vmax=1)
    loop = (point_cloud(cycle.at(np.linspace(0, 1, 200), frame_time=0.01)) - centre) @ axes_2d
    axes.plot(loop[:, 0], loop[:, 1], color=_ACCENT, lw=2.5, label="cycle")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_title("capture and cycle, principal components 1 and 2")
    axes.legend(loc="upper right", frameon=False)
    axes.set_xticks([])
    axes.set_yticks([])


def overview(motion: Motion, cycles: list[Cycle]) -> Figure:
    """Draw one row a cycle: barcode, coordinate, plane.

    Parameters
    ----------
    motion : Motion
        The capture.
    cycles : list of Cycle
        As from `roundelay.find_cycles`.

    Returns
    -------
    matplotlib.figure.Figure
    """
    motion = motion.with_root_motion()
    figure = new_figure(17.0, 4.8 * len(cycles))
    grid = figure.subplots(len(cycles), 3, squeeze=False, width_ratios=(1.0, 1.4, 1.2))
    for row, cycle in zip(grid, cycles, strict=True):
        if cycle.evidence is not None:
            barcode(row[0], cycle.evidence.barcode, cycle.evidence.coordinate.class_index)
            coordinate(row[1], cycle.evidence, motion)
            row[1].set_title(
                f"circular coordinate: {cycle.evidence.repetitions:.2f} turns, "
                f"period {cycle.period:.2f} s"
            )
        plane(row[2], cycle, motion)
    figure.suptitle(motion.name)
    return figure


def save(figure: Figure, path: Path, *, dpi: int = 90) -> None:
    """Write a figure in the format of the path's suffix, whole or not at all."""
    with written_beside(path) as part:
        figure.savefig(part, dpi=dpi)


def new_figure(width: float, height: float) -> Figure:
    """Make a figure of a width and height in inches."""
    # The object-oriented interface draws without a screen and without global state.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure
