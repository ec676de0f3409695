"""The picture of ``roundelay excitations``: where the coordinates of a capture turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from roundelay.motion.motion import Motion
from roundelay.output.figures.overview import barcode
from roundelay.output.figures.palette import PALE, phase_colours
from roundelay.output.figures.style import dress, headed, new_figure
from roundelay.timeline.proposals.excitation import Excitation, Excitations

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["excitations"]


def excitations(motion: Motion, found: Excitations, *, start: int = 0) -> Figure:
    """Draw the barcode, and each class's coordinate over time with its regions ([A] fig. 7-11).

    Parameters
    ----------
    motion : Motion
        The capture.
    found : Excitations
        As from `roundelay.timeline.proposals.excitation.excitations`.
    start : int
        The capture's frame at which what was looked at begins.

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows = max(1, len(found.classes))
    figure = new_figure(15.0, max(4.0, 1.5 * rows))
    grid = figure.add_gridspec(rows, 2, width_ratios=(1.0, 2.6))
    colours = phase_colours(rows)
    numbers = [one.coordinate.class_index for one in found.classes]
    shown = dict(zip(numbers, colours, strict=False))
    barcode(found.barcode, shown, axes=figure.add_subplot(grid[:, 0]))
    for row, one in enumerate(found.classes):
        _coordinate(figure.add_subplot(grid[row, 1]), motion, one, start, colours[row])
    for axes in figure.axes[1:-1]:
        axes.set_xlabel("")
        axes.tick_params(labelbottom=False)
    if not found.classes:
        dress(figure.add_subplot(grid[0, 1]), "no class stands out from noise")
    headed(figure, motion.name)
    return figure


def _coordinate(axes: Axes, motion: Motion, one: Excitation, start: int, colour: str) -> None:
    seconds = (start + np.arange(len(one.turns))) * motion.frame_time
    resting = np.ones(len(one.turns), bool)
    for region in one.regions:
        axes.axvspan(seconds[region.start], seconds[region.stop - 1], color=PALE, alpha=0.35, lw=0)
        resting[region.start : region.stop] = False
    # A coordinate has no origin: here it rests at a tenth of a turn.
    rest = np.angle(np.exp(2j * np.pi * one.turns[resting]).sum()) / (2 * np.pi)
    axes.scatter(seconds, (one.turns - rest + 0.1) % 1.0, color=colour, s=3)
    axes.set_xlim(0.0, motion.duration)
    axes.set_ylim(-0.05, 1.05)
    chance = f"class {one.coordinate.class_index}, p {one.p_value:.1g}"
    dress(axes, chance, x="time (s)", y="coordinate")
