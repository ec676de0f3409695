"""From structure to time: the coordinate's density, its remaps and the line of the period."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roundelay.motion.motion import Motion
from roundelay.output.figures.palette import ACCENT, INK, PALE
from roundelay.output.figures.style import dress, given_or_new, new_figure, phase_look
from roundelay.phase.mixture import fit_circular_mixture
from roundelay.phase.period import line_period
from roundelay.phase.phase_map import phase_map, rank_remap
from roundelay.timeline.evidence import Evidence

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["circle_density", "density", "period_line", "remaps"]

Array = NDArray[np.float64]

_GRID = np.linspace(0.0, 1.0, 401)


def density(evidence: Evidence, *, axes: Axes | None = None) -> Axes:
    """Draw the coordinate's histogram and its mixture density ([A] fig. 3, [C] fig. 3.6)."""
    axes = given_or_new(axes)
    phase = _phases(evidence)
    axes.hist(
        phase,
        bins=int(np.clip(len(phase) / 12, 12, 60)),
        range=(0.0, 1.0),
        density=True,
        color=PALE,
    )
    height = fit_circular_mixture(phase).density(_GRID)
    axes.plot(_GRID, height, color=ACCENT, lw=2, label="mixture of 30 Gaussians")
    dress(axes, "density of the circular coordinate", x="coordinate (turns)", y="density")
    axes.set_xlim(0.0, 1.0)
    axes.legend(frameon=False, fontsize=9)
    return axes


def circle_density(evidence: Evidence, *, axes: Axes | None = None) -> Axes:
    """Draw the same around the circle, on polar axes."""
    axes = given_or_new(axes, projection="polar")
    phase = _phases(evidence)
    height = fit_circular_mixture(phase).density(_GRID)
    angle = 2 * np.pi * _GRID
    around = 1.0 + 0.5 * height / height.max()
    axes.fill_between(angle, 1.0, around, color=ACCENT, alpha=0.3, lw=0)
    axes.plot(angle, around, color=ACCENT, lw=1.5)
    axes.scatter(2 * np.pi * phase, np.ones(len(phase)), c=phase, s=8, **phase_look())
    axes.set_ylim(0.0, 1.55)
    axes.set_axis_off()
    axes.set_title("density around the circle", fontsize=10.5)
    return axes


def _phases(evidence: Evidence) -> Array:
    return np.concatenate([evidence.turns[start:stop] for start, stop in evidence.runs]) % 1.0


def remaps(motion: Motion, evidence: Evidence) -> Figure:
    """Draw the coordinate over time and its three maps to time ([C] figs. 3.2, 3.3, 3.5).

    Parameters
    ----------
    motion : Motion
        The capture.
    evidence : Evidence
        As a cycle carries it.

    Returns
    -------
    matplotlib.figure.Figure
    """
    phase = _phases(evidence)
    by_speed = phase_map(evidence.turns, evidence.runs)(phase)
    maps = {
        "circular coordinate": phase,
        "spread by ranks ([C] 3.20)": rank_remap(phase),
        "spread by a mixture ([C] 3.21)": fit_circular_mixture(phase).distribution(phase),
        "by the speed of traversal (default)": by_speed,
    }
    inside = evidence.runs.frames
    figure = new_figure(14.0, 3.2)
    row = figure.subplots(1, len(maps), sharey=True)
    for axes, (title, values) in zip(row, maps.items(), strict=True):
        axes.scatter(inside * motion.frame_time, values, c=phase, s=5, **phase_look())
        dress(axes, title, x="time (s)", y="phase")
    return figure


def period_line(evidence: Evidence, motion: Motion, *, axes: Axes | None = None) -> Axes:
    """Draw the unwrapped time phase with a line of the period through each part ([C] fig. 3.7)."""
    axes = given_or_new(axes)
    mapping = phase_map(evidence.turns, evidence.runs)
    phase = np.where(np.isfinite(evidence.turns), mapping(np.nan_to_num(evidence.turns)), np.nan)
    period = line_period(phase, evidence.runs)
    for start, stop in evidence.runs:
        frames = np.arange(start, stop)
        part = phase[start:stop]
        line = part.mean() + (frames - frames.mean()) / period
        seconds = frames * motion.frame_time
        axes.scatter(seconds, part, c=part % 1.0, s=5, **phase_look())
        axes.plot(seconds, line, color=INK, lw=1)
    title = f"period {period * motion.frame_time:.2f} s ({period:.1f} frames)"
    dress(axes, title, x="time (s)", y="periods")
    return axes
