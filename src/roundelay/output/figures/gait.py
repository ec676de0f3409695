"""The picture of steps and strides: when feet stand, and every stride's time and length."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from roundelay.gait.result import Strides
from roundelay.output.figures.palette import phase_colours
from roundelay.output.figures.style import dress, given_or_new, headed, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["stances", "steps", "stride_line"]


def steps(told: Strides) -> Figure:
    """Draw when feet stand, and time and length of every stride with the mean's interval.

    Parameters
    ----------
    told : Strides

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = new_figure(11.0, 6.5)
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 1.4, 1.4))
    stances(told, axes=above)
    stride_line(told, "time", axes=middle)
    stride_line(told, "length", axes=below)
    below.set_xlabel("time of the take (s)", fontsize=9.5)
    count = f"{len(told.strides)} strides, moments by {told.rule}"
    headed(figure, f"{told.name}: {count}".lstrip(": "))
    return figure


def stances(told: Strides, *, axes: Axes | None = None) -> Axes:
    """Draw a bar where each foot stands, from a strike to the foot's next off."""
    axes = given_or_new(axes)
    for row, foot in enumerate(told.feet):
        moments = [one for one in told.events if one.foot == foot]
        for one, after in pairwise(moments):
            if (one.kind, after.kind) == ("strike", "off"):
                start, stop = one.frame / told.fps, after.frame / told.fps
                axes.barh(row, stop - start, left=start, color=_colour(told, foot), height=0.7)
    axes.set_yticks(range(len(told.feet)), told.feet)
    axes.set_ylim(len(told.feet) - 0.4, -0.6)
    dress(axes, "feet on the ground", x=" ", y=" ")
    return axes


def stride_line(told: Strides, quantity: str, *, axes: Axes | None = None) -> Axes:
    """Draw a quantity of every stride at its start, and the interval of each foot's mean."""
    axes = given_or_new(axes)
    for foot in told.feet:
        own = [stride for stride in told.strides if stride.foot == foot]
        colour, spread = _colour(told, foot), told.summary[foot][quantity]
        starts, values = [x.start for x in own], [x.value(quantity) for x in own]
        axes.plot(starts, values, "o-", color=colour, ms=4, lw=1.0, label=foot)
        if np.isfinite(spread.low):
            axes.axhspan(spread.low, spread.high, color=colour, alpha=0.2, lw=0)
    unit = told.unit_of(quantity)
    dress(axes, f"{quantity} of strides", x=" ", y=f"{quantity} ({unit})" if unit else quantity)
    axes.legend(fontsize=8.5, frameon=False, loc="upper right")
    axes.grid(alpha=0.3)
    return axes


def _colour(told: Strides, foot: str) -> str:
    return phase_colours(len(told.feet))[told.feet.index(foot)]
