"""The picture of a comparison: both groups along the phase, and their difference with its band."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from roundelay.compare.relative import RelativePhase
from roundelay.compare.waveforms import Comparison
from roundelay.output.figures.palette import INK, phase_colours
from roundelay.output.figures.style import dress, given_or_new, headed, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["comparison", "coordination", "curves", "difference"]


def comparison(found: Comparison, *, most: int = 4) -> Figure:
    """Draw the curves that differ most, above their differences.

    Parameters
    ----------
    found : Comparison
    most : int
        How many, those of the smallest p first.

    Returns
    -------
    matplotlib.figure.Figure
    """
    sizes = np.abs(found.t).max(axis=1)
    names = [found.names[k] for k in np.argsort(-sizes)[:most]]
    figure = new_figure(3.2 * len(names) + 0.8, 5.4)
    rows = figure.subplots(2, len(names), sharex=True, squeeze=False)
    for name, above, below in zip(names, *rows, strict=True):
        curves(found, name, axes=above)
        difference(found, name, axes=below)
        below.set_xlabel("phase (turns)", fontsize=9.5)
    lines = rows[0, 0].get_lines()
    means = lines[len(found.first)], lines[-1]
    figure.legend(
        means, found.labels, fontsize=8.5, frameon=False, loc="outside lower center", ncols=2
    )
    headed(figure, f"{found.labels[0]} and {found.labels[1]}")
    return figure


def curves(found: Comparison, name: str, *, axes: Axes | None = None) -> Axes:
    """Draw each repetition of both groups, and their means."""
    axes, number = given_or_new(axes), found.names.index(name)
    for group, label, colour in zip(
        (found.first, found.second), found.labels, phase_colours(2), strict=True
    ):
        axes.plot(found.phase, group[:, number].T, color=colour, lw=0.6, alpha=0.35)
        axes.plot(found.phase, group[:, number].mean(axis=0), color=colour, lw=2.2, label=label)
    p = found.p[found.names.index(name)]
    dress(axes, f"{name}, p {p:.3g}", x=" ", y="degrees")
    return axes


def difference(found: Comparison, name: str, *, axes: Axes | None = None) -> Axes:
    """Draw the difference with its band, and mark where it is one."""
    axes, number = given_or_new(axes), found.names.index(name)
    axes.fill_between(
        found.phase, found.low[number], found.high[number], color=INK, alpha=0.15, lw=0
    )
    axes.plot(found.phase, found.difference[number], color=INK, lw=1.8)
    axes.axhline(0.0, color=INK, lw=0.7)
    for start, stop in found.differing(name):
        axes.axvspan(start, stop, color=phase_colours(3)[2], alpha=0.2, lw=0)
    dress(axes, "the first less the second", x=" ", y="degrees")
    return axes


def coordination(told: RelativePhase, *, axes: Axes | None = None) -> Axes:
    """Draw the places of two joints against each other: each repetition, and their mean.

    A line up means that they swing together, one down against each other, a ring that one follows.
    """
    axes, colour = given_or_new(axes), phase_colours(2)[1]
    for first, second in zip(told.first, told.second, strict=True):
        axes.plot(first, second, color=colour, lw=0.6, alpha=0.5)
    axes.plot(told.first.mean(axis=0), told.second.mean(axis=0), color=INK, lw=2.0)
    title = f"{told.mean:+.2f} turns later, alike by {told.resultant:.2f}"
    dress(axes, title, x="first (body sizes)", y="second (body sizes)")
    axes.set_aspect("equal", adjustable="datalim")
    return axes
