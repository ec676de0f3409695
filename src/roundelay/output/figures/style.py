"""The look that all figures share, and how they are made and saved."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roundelay.base.files import written_beside
from roundelay.base.texts import shown
from roundelay.output.figures.palette import MUTED, phase_colours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure

__all__ = ["dress", "given_or_new", "headed", "new_figure", "phase_look", "save"]


def new_figure(width: float, height: float) -> Figure:
    """Make a figure of a width and height in inches."""
    # The object-oriented interface draws without a screen and without global state.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def given_or_new(axes: Axes | None, *, projection: str | None = None) -> Axes:
    """Return the caller's axes, or without them those of a new figure, ``axes.figure``."""
    if axes is None:
        return new_figure(6.0, 4.5).add_subplot(projection=projection)
    return axes


def dress(axes: Axes, title: str = "", *, x: str = "", y: str = "") -> None:
    """Give axes the common look, a title and names; axes without a name lose their ticks."""
    axes.set_title(title, loc="left", fontsize=10.5)
    axes.set_xlabel(x, fontsize=9.5)
    axes.set_ylabel(y, fontsize=9.5)
    axes.tick_params(labelsize=9, color=MUTED)
    for side, name in {"top": "", "right": "", "bottom": x, "left": y}.items():
        axes.spines[side].set_visible(bool(name))
        axes.spines[side].set_color(MUTED)
    if not x:
        axes.set_xticks([])
    if not y:
        axes.set_yticks([])


def headed(figure: Figure, name: str) -> None:
    """Write a name above a figure as it is: signs in it are no formula."""
    figure.suptitle(shown(name), parse_math=False)


def phase_look() -> dict[str, Any]:
    """Return what makes ``scatter(..., c=phase)`` colour by phase as the page does."""
    from matplotlib.colors import ListedColormap

    colours: ListedColormap = ListedColormap(phase_colours(256))
    return {"cmap": colours, "vmin": 0.0, "vmax": 1.0}


def save(figure: Figure, path: str | Path, *, dpi: int = 90) -> None:
    """Write a figure in the format of the path's suffix, whole or not at all."""
    with written_beside(Path(path)) as part, warnings.catch_warnings():
        # Letters that no font has are drawn as boxes; nobody can do anything about it.
        warnings.filterwarnings("ignore", r"Glyph .* missing from", UserWarning)
        figure.savefig(part, dpi=dpi)
