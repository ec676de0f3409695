"""Poses as pictures: a strip of them, and a moving picture of a loop."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.files import written_beside
from roundelay.motion.motion import Motion
from roundelay.output.figures.palette import INK, MUTED, phase_colours
from roundelay.output.figures.space import Space, bones
from roundelay.output.figures.style import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["animation", "strip"]

Array = NDArray[np.float64]

_LEFT, _RIGHT = "#2f7f95", "#a8652f"
_LIMB: dict[str, Any] = {"lw": 3.2, "solid_capstyle": "round"}
# Radius in body sizes.
_HEAD = 0.042


def strip(motion: Motion, *, poses: int = 9, colour_by_phase: bool = True) -> Figure:
    """Draw some poses of a motion side by side, seen from the side it faces.

    Parameters
    ----------
    motion : Motion
        A loop, for instance `Cycle.sample`.
    poses : int
        How many, at equal steps of time.
    colour_by_phase : bool
        Colour poses by their place in the motion.

    Returns
    -------
    matplotlib.figure.Figure
    """
    frames = np.arange(poses) * len(motion) // poses
    views = _side_views(motion)[frames]
    width, height = 0.62, float(views[..., 1].max() * 1.06)
    figure = new_figure(1.35 * poses, 1.35 * height / width)
    axes = figure.subplots()
    colours = phase_colours(poses, lightness=0.62) if colour_by_phase else [INK] * poses
    for number, (view, colour) in enumerate(zip(views, colours, strict=True)):
        _draw(axes, view + np.array([number * width, 0.0]), motion, [colour] * 3)
    axes.plot([-0.5 * width, (poses - 0.5) * width], [0, 0], color=MUTED, lw=0.8, zorder=0)
    _frame(axes, (-0.5 * width, (poses - 0.5) * width), (-0.02, height))
    return figure


def animation(motion: Motion, path: Path, *, fps: float = 25.0, size: int = 320) -> None:
    """Write a moving picture of a motion, without end, as GIF or as PNG (by the suffix).

    Parameters
    ----------
    motion : Motion
        A loop, for instance `Cycle.sample`.
    path : Path
        Ends in ``.gif`` or ``.png``.
    fps : float
        Frames a second; GIFs are shown at steps of a hundredth of a second.
    size : int
        Height in pixels.

    Raises
    ------
    ValueError
        If the suffix is another.
    """
    if path.suffix.lower() not in (".gif", ".png"):
        raise ValueError(f"expected a moving picture of type .gif or .png, found {path.name!r}")
    # A whole number of frames a period: the first follows the last.
    count = max(2, round(motion.duration * fps))
    shown = motion.at(np.arange(count) * len(motion) / count)
    images = list(_images(shown, size))
    with written_beside(path) as part:
        images[0].save(
            part,
            save_all=True,
            append_images=images[1:],
            duration=round(100.0 * motion.duration / count) * 10,
            loop=0,
            **({"disposal": 1} if path.suffix.lower() == ".gif" else {}),
        )


def _images(motion: Motion, size: int) -> Iterator[Any]:
    from PIL import Image

    views = _side_views(motion)
    height = float(views[..., 1].max() * 1.08)
    reach = max(0.3, 1.06 * float(np.abs(views[..., 0]).max()))
    figure = new_figure(2 * reach * size / height / 100, size / 100)
    figure.set_layout_engine("none")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    for view in views:
        axes.clear()
        axes.plot([-reach, reach], [0, 0], color=MUTED, lw=0.8, zorder=0)
        _draw(axes, view, motion, [_LEFT, INK, _RIGHT])
        _frame(axes, (-reach, reach), (-0.03 * height, height))
        figure.canvas.draw()
        pixels = np.asarray(figure.canvas.buffer_rgba())  # type: ignore[attr-defined]
        yield Image.fromarray(pixels).convert("RGB").quantize(32, dither=Image.Dither.NONE)


def _frame(axes: Axes, across: tuple[float, float], upwards: tuple[float, float]) -> None:
    axes.set_xlim(across)
    axes.set_ylim(upwards)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _side_views(motion: Motion) -> Array:
    """Project joints and ends of limbs (F, P, 2): forwards and up, the root at 0."""
    motion = motion.with_root_motion()
    points = Space.of(motion).points(motion)
    path = points[:, 0, [0, 2]]
    level = points[..., [0, 2]] - path[:, None]
    forwards = path[-1] - path[0]
    if np.linalg.norm(forwards) < 0.1:
        # In place: look from where the poses differ most.
        means = level.mean(axis=1)
        forwards = np.linalg.svd(means - means.mean(axis=0), full_matrices=False)[2][0]
    forwards = forwards / np.linalg.norm(forwards)
    return np.stack([level @ forwards, points[..., 1]], axis=-1)


def _draw(axes: Axes, view: Array, motion: Motion, colours: list[str]) -> None:
    """Draw one pose (P, 2) in the colours of its left, middle and right."""
    from matplotlib.patches import Circle

    for bone in bones(motion.skeleton):
        colour, line = colours[bone.side + 1], view[[bone.start, bone.stop]]
        axes.plot(line[:, 0], line[:, 1], color=colour, zorder=2 + bone.side, **_LIMB)
        if bone.is_head:
            x, y = line.mean(axis=0).tolist()
            axes.add_patch(Circle((x, y), _HEAD, color=colour, lw=0, zorder=3))
