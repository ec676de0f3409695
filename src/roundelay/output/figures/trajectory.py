"""The capture's joint angles beside the loop's, with their jerk ([A] fig. 6)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roundelay.cycles.cycle import Cycle
from roundelay.geometry import rotations as rot
from roundelay.loops.quality import jerk
from roundelay.motion.features import joint_turns
from roundelay.motion.motion import Motion
from roundelay.output.figures.overview import in_plane
from roundelay.output.figures.palette import ACCENT, INK, PALE, phase_colours
from roundelay.output.figures.style import dress, given_or_new, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["angles", "typical_trajectory"]

Array = NDArray[np.float64]


def angles(
    motion: Motion, cycle: Cycle, *, joints: Sequence[str] | None = None, periods: int = 3
) -> Figure:
    """Draw joint angles of capture and loop over some periods, and the jerk over one.

    Parameters
    ----------
    motion : Motion
        The capture.
    cycle : Cycle
        Found in it.
    joints : sequence of str, optional
        The six that turn most by default.
    periods : int
        How many, at most as many as the longest part holds.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If the cycle carries no evidence of where it was found.
    SkeletonMismatch
        If a joint does not exist.
    """
    if cycle.evidence is None:
        raise ValueError("expected a cycle found in a capture, with its evidence")
    frames = round(cycle.period * motion.fps)
    start, stop = max(cycle.evidence.runs, key=lambda run: run[1] - run[0])
    stop = min(stop, start + periods * frames)
    shown = motion.with_root_motion()[start:stop]
    chosen = _liveliest(shown) if joints is None else motion.skeleton.indices(joints)
    loop = cycle.sample(motion.fps, periods=periods + 1).with_root_motion()
    offset = _offset(shown, loop, frames)
    loop = loop[offset : offset + len(shown)]
    means, turning = _axes_of_turning(shown, chosen)
    figure = new_figure(13.0, 6.0)
    grid = figure.subplots(2, 2, sharex="col", sharey="col", width_ratios=(2.2, 1.0))
    names = [motion.skeleton.names[joint] for joint in chosen]
    for row, part, title in zip(grid, (shown, loop), ("capture", "loop"), strict=True):
        _draw(row[0], row[1], _degrees(part, chosen, means, turning), motion.fps, frames, title)
    figure.legend(names, loc="outside lower center", ncols=6, frameon=False, fontsize=9)
    return figure


def _draw(left: Axes, right: Axes, values: Array, fps: float, frames: int, title: str) -> None:
    seconds = np.arange(len(values)) / fps
    rough = np.abs(jerk(values[: frames + 6], fps))
    for column, colour in enumerate(phase_colours(values.shape[1], lightness=0.6)):
        left.plot(seconds, values[:, column], color=colour, lw=1.3)
        right.plot(seconds[: len(rough)], rough[:, column], color=colour, lw=0.9)
    right.set_yscale("log")
    dress(left, f"angles of the {title}", x="time (s)", y="degrees")
    dress(right, f"jerk of the {title}, one period", x="time (s)", y="degrees / s³")


def _axes_of_turning(motion: Motion, joints: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return each joint's mean pose (k, 4) and the axis (k, 3) about which it turns most."""
    means = rot.normalize(joint_turns(motion)[:, joints].mean(axis=0))
    vectors = rot.vector_between(means, joint_turns(motion)[:, joints])
    axes = [np.linalg.svd(vectors[:, k], full_matrices=False)[2][0] for k in range(len(joints))]
    return means, np.array(axes)


def _degrees(motion: Motion, joints: NDArray[np.intp], means: Array, axes: Array) -> Array:
    """Return each joint's angle (F, k) from its mean pose, about its axis."""
    away = rot.vector_between(means, joint_turns(motion)[:, joints])
    return np.degrees(np.einsum("fkc,kc->fk", away, axes))


def _liveliest(motion: Motion, count: int = 6) -> NDArray[np.intp]:
    turns = joint_turns(motion)
    vectors = rot.vector_between(turns[:1], turns)
    spread = vectors.var(axis=0).sum(axis=-1)
    spread[0] = 0.0
    return np.sort(np.argsort(spread)[::-1][:count])


def _offset(shown: Motion, loop: Motion, frames: int) -> int:
    """Return the frame of the loop at which it matches the shown part best."""
    count = min(len(shown), frames)
    ours, theirs = joint_turns(loop)[:, 1:], joint_turns(shown[:count])[:, 1:]

    def apart(offset: int) -> float:
        turned = rot.angle_between(ours[offset : offset + count], theirs)
        return float(np.sum(turned**2))

    return min(range(frames), key=apart)


def typical_trajectory(
    cycle: Cycle, motion: Motion, *, phase: float = 0.12, axes: Axes | None = None
) -> Axes:
    """Draw the ten poses nearest to a coordinate, and the curve of poses ([A] fig. 4).

    Raises
    ------
    ValueError
        If the cycle carries no evidence of where it was found.
    """
    if cycle.evidence is None:
        raise ValueError("expected a cycle found in a capture, with its evidence")
    axes = given_or_new(axes)
    seen, curve, frames = in_plane(cycle, motion.with_root_motion())
    away = np.abs((cycle.evidence.turns[frames] - phase + 0.5) % 1.0 - 0.5)
    near = frames[np.argsort(away)[:10]]
    axes.scatter(seen[frames, 0], seen[frames, 1], color=PALE, s=5)
    axes.plot(*curve.T, color=INK, lw=2, label="cycle")
    label = f"ten nearest to coordinate {phase:g}"
    axes.scatter(seen[near, 0], seen[near, 1], color=ACCENT, s=22, label=label)
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(frameon=False, fontsize=9)
    dress(axes, "typical trajectory, principal components 1 and 2")
    return axes
