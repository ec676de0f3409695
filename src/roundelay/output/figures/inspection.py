"""The picture of ``roundelay inspect``: barcode, persistence diagram, coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from roundelay.motion.motion import Motion
from roundelay.output.figures.overview import bar_colours, barcode, coordinate, new_figure
from roundelay.output.figures.palette import ACCENT, INK, PALE
from roundelay.output.figures.style import dress, given_or_new, headed
from roundelay.timeline.inspection import ClassFigures, Inspection

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from roundelay.topology.rips import Barcode

__all__ = ["inspection", "persistence_diagram"]


def persistence_diagram(
    bars: Barcode, chosen: int = 0, *, axes: Axes | None = None, unit: str = "body sizes"
) -> Axes:
    """Draw births against deaths, the chosen class in colour and the first ones numbered."""
    axes, deaths = given_or_new(axes), np.minimum(bars.deaths, bars.max_scale)
    far = 1.05 * float(np.max(deaths, initial=1e-9))
    axes.plot([0, far], [0, far], color=PALE, lw=1)
    axes.scatter(bars.births, deaths, color=INK, s=14)
    axes.scatter(bars.births[chosen : chosen + 1], deaths[chosen : chosen + 1], color=ACCENT, s=40)
    for index in range(min(len(bars), 5)):
        place = (float(bars.births[index]), float(deaths[index]))
        axes.annotate(str(index), place, xytext=(5, 3), textcoords="offset points")
    axes.set_xlim(0, far)
    axes.set_ylim(0, far)
    axes.set_aspect("equal")
    dress(axes, "persistence diagram, degree 1", x=f"birth ({unit})", y=f"death ({unit})")
    return axes


def inspection(motion: Motion, found: list[Inspection]) -> Figure:
    """Draw two rows a motion: barcode, persistence diagram, and each class's coordinate.

    Parameters
    ----------
    motion : Motion
        The capture.
    found : list of Inspection
        As from `roundelay.timeline.inspection.inspect`.

    Returns
    -------
    matplotlib.figure.Figure
    """
    across = -(-max(len(item.classes) for item in found) // 2)
    figure = new_figure(4.2 * (2 + across), 6.0 * len(found))
    grid = figure.add_gridspec(2 * len(found), 2 + across)
    for top, item in zip(range(0, 2 * len(found), 2), found, strict=True):
        chosen = item.evidence.coordinate.class_index
        bars = figure.add_subplot(grid[top : top + 2, 0])
        barcode(item.evidence.barcode, bar_colours(item.evidence), axes=bars)
        diagram = figure.add_subplot(grid[top : top + 2, 1])
        persistence_diagram(item.evidence.barcode, chosen, axes=diagram)
        for place, one in enumerate(item.classes):
            row, column = divmod(place, across)
            _one_class(figure.add_subplot(grid[top + row, 2 + column]), one, motion)
    headed(figure, motion.name)
    return figure


def _one_class(axes: Axes, one: ClassFigures, motion: Motion) -> None:
    if one.evidence is None:
        axes.text(0.5, 0.5, one.fault, ha="center", wrap=True, transform=axes.transAxes)
        dress(axes, f"class {one.index}")
        return
    coordinate(one.evidence, motion, axes=axes)
    dress(axes, f"class {one.index}: {one.evidence.net:.2f} turns", x="time (s)", y="turns")
