"""The evidence and the cycle: barcode, coordinate, poses in the plane ([A] fig. 4)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roundelay.base.threads import one_thread
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.output.figures.palette import ACCENT, COMPANION, INK, PALE
from roundelay.output.figures.style import dress, given_or_new, headed, new_figure, phase_look, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from roundelay.cycles.cycle import Cycle
    from roundelay.timeline.evidence import Evidence
    from roundelay.topology.rips import Barcode

__all__ = [
    "bar_colours",
    "barcode",
    "coordinate",
    "in_plane",
    "new_figure",
    "overview",
    "plane",
    "save",
]

Array = NDArray[np.float64]

_MOST_BARS = 30


def barcode(
    bars: Barcode,
    chosen: int | Mapping[int, str] = 0,
    *,
    axes: Axes | None = None,
    unit: str = "body sizes",
) -> Axes:
    """Draw degree-1 bars, the longest at the bottom, chosen ones in colour ([A] fig. 4, 7)."""
    axes, deaths = given_or_new(axes), np.minimum(bars.deaths, bars.max_scale)
    colours = {chosen: ACCENT} if isinstance(chosen, int) else chosen
    shown = min(len(bars), max(_MOST_BARS, 1 + max(colours, default=0)))
    for row in range(shown):
        colour = colours.get(row, INK)
        axes.plot([bars.births[row], deaths[row]], [row, row], color=colour, lw=2.5)
    hidden = len(bars) - shown
    title = "barcode, degree 1" + (f" ({hidden} short bars not shown)" if hidden else "")
    dress(axes, title, x=f"scale ({unit})")
    axes.set_xlim(left=0.0)
    axes.set_ylim(-1, max(shown, 3))
    return axes


def bar_colours(evidence: Evidence) -> dict[int, str]:
    """Return the colours of the bar used and of those that tell of the same motion."""
    colours = dict.fromkeys(evidence.companions, COMPANION)
    return colours | {evidence.coordinate.class_index: ACCENT}


def coordinate(evidence: Evidence, motion: Motion, *, axes: Axes | None = None) -> Axes:
    """Draw the unwrapped circular coordinate of every periodic part over time ([C] fig. 3.7)."""
    axes = given_or_new(axes)
    seconds = np.arange(len(motion)) * motion.frame_time
    for start, stop in evidence.runs:
        axes.axvspan(seconds[start], seconds[stop - 1], color=PALE, alpha=0.35, lw=0)
        turns = evidence.turns[start:stop]
        axes.scatter(seconds[start:stop], turns, c=turns % 1.0, s=5, **phase_look())
    axes.set_xlim(0.0, motion.duration)
    dress(axes, "circular coordinate, unwrapped", x="time (s)", y="turns")
    axes.grid(alpha=0.3)
    return axes


def plane(cycle: Cycle, motion: Motion, *, axes: Axes | None = None) -> Axes:
    """Draw capture and cycle in the capture's first two principal components ([A] fig. 4)."""
    axes = given_or_new(axes)
    seen, curve, frames = in_plane(cycle, motion)
    axes.plot(seen[:, 0], seen[:, 1], color=PALE, lw=0.5, zorder=0)
    if cycle.evidence is not None:
        phase = cycle.evidence.turns[frames] % 1.0
        axes.scatter(seen[frames, 0], seen[frames, 1], c=phase, s=6, **phase_look())
    axes.plot(curve[:, 0], curve[:, 1], color=INK, lw=2.0, label="cycle")
    axes.set_aspect("equal", adjustable="datalim")
    dress(axes, "capture and cycle, principal components 1 and 2")
    axes.legend(loc="upper right", frameon=False, fontsize=9)
    return axes


@one_thread
def in_plane(cycle: Cycle, motion: Motion) -> tuple[Array, Array, NDArray[np.intp]]:
    """Project capture (F, 2) and cycle (200, 2) on the plane of the frames that show the motion.

    Returns
    -------
    capture, cycle : ndarray
    frames : (n,) ndarray of int
        The frames that show the motion; all if the cycle does not tell.
    """
    points = point_cloud(motion)
    frames = np.arange(len(motion))
    if cycle.evidence is not None:
        frames = cycle.evidence.runs.frames
    centre = points[frames].mean(axis=0)
    axes = np.linalg.svd(points[frames] - centre, full_matrices=False)[2][:2].T
    around = point_cloud(cycle.at(np.linspace(0, 1, 200), frame_time=0.01).with_root_motion())
    return (points - centre) @ axes, (around - centre) @ axes, frames


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
            barcode(cycle.evidence.barcode, bar_colours(cycle.evidence), axes=row[0])
            coordinate(cycle.evidence, motion, axes=row[1])
            found = f"{cycle.evidence.repetitions:.2f} periods of {cycle.period:.2f} s"
            dress(row[1], f"circular coordinate: {found}", x="time (s)", y="turns")
        plane(cycle, motion, axes=row[2])
    headed(figure, motion.name)
    return figure
