"""The picture of a segmentation: the method's curve, the cuts, the behaviours over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from roundelay.output.figures.overview import new_figure
from roundelay.output.figures.palette import ACCENT, INK, phase_colours
from roundelay.output.figures.style import dress, given_or_new, headed
from roundelay.segmentation.result import Segment, Segmentation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["behaviours", "method_curve", "timeline"]


def timeline(found: Segmentation) -> Figure:
    """Draw the method's curve with the cuts ([B] figures 1, 2, 4), and the behaviours below.

    Parameters
    ----------
    found : Segmentation

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = new_figure(14.0, 4.5)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1.0))
    method_curve(found, axes=above)
    behaviours(found, axes=below)
    headed(figure, f"{found.source}: {len(found)} segments, {found.method}".lstrip(": "))
    return figure


def method_curve(found: Segmentation, *, axes: Axes | None = None) -> Axes:
    """Draw what the method watched over seconds, with a line at each cut."""
    axes = given_or_new(axes)
    axes.plot(found.curve.frames * found.frame_time, found.curve.values, color=INK, lw=1.2)
    for cut in found.cuts:
        axes.axvline(cut * found.frame_time, color=ACCENT, lw=1.2)
    dress(axes, x=" ", y=found.curve.meaning)
    axes.grid(alpha=0.3)
    return axes


def behaviours(found: Segmentation, *, axes: Axes | None = None) -> Axes:
    """Draw one bar a segment, a row and a colour a behaviour; periods are written on it."""
    axes = given_or_new(axes)
    count = 1 + max(segment.label for segment in found.segments)
    colours = phase_colours(count)
    for segment in found.segments:
        start, length = segment.start * found.frame_time, len(segment) * found.frame_time
        axes.barh(segment.label, length, left=start, color=colours[segment.label], height=0.8)
        axes.text(start + length / 2, segment.label, _caption(segment), **_CENTRED)
    axes.set_yticks(np.arange(count))
    axes.set_ylim(count - 0.4, -0.6)
    axes.set_xlim(0.0, found.n_frames * found.frame_time)
    dress(axes, x="time (s)", y="behaviour")
    return axes


_CENTRED: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 8, "clip_on": True}


def _caption(segment: Segment) -> str:
    return "" if segment.period is None else f"{segment.period:.2f} s"
