"""Options of the search that ``loop`` and ``inspect`` share: all automatic unless given."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from roundelay.commands.common import frame_range

if TYPE_CHECKING:
    from roundelay.motion import Motion
    from roundelay.pipeline import Options

__all__ = [
    "Class",
    "Delay",
    "Delays",
    "Dimensions",
    "Features",
    "Gestures",
    "Joints",
    "Metric",
    "Prime",
    "Scale",
    "Weights",
    "search_options",
]

_SEARCH = "What repeats"

Joints = Annotated[
    str | None,
    typer.Option(
        help="Joints that decide what repeats, with commas.",
        show_default=False,
        rich_help_panel=_SEARCH,
    ),
]
Features = Annotated[
    str,
    typer.Option(
        help="What a pose is: positions, heading, quaternions or angles.", rich_help_panel=_SEARCH
    ),
]
Weights = Annotated[
    str,
    typer.Option(help="Weigh joints: none, length or mass.", rich_help_panel=_SEARCH),
]
Metric = Annotated[
    str,
    typer.Option(
        help="Distance of poses: euclidean, variance or adjacent.", rich_help_panel=_SEARCH
    ),
]
Dimensions = Annotated[
    float | None,
    typer.Option(
        help="Principal axes to project on, or the share of variance (below 1) they hold.",
        show_default=False,
        rich_help_panel=_SEARCH,
    ),
]
Delay = Annotated[
    float | None,
    typer.Option(
        help="Seconds by which velocity is weighed against position; 0 for poses alone.",
        show_default=False,
        rich_help_panel=_SEARCH,
    ),
]
Delays = Annotated[
    int | None,
    typer.Option(
        help="Delays over half a period, instead of velocities.",
        min=1,
        show_default=False,
        rich_help_panel=_SEARCH,
    ),
]
Prime = Annotated[
    int,
    typer.Option(help="Coefficients are integers modulo this prime.", rich_help_panel=_SEARCH),
]
Class = Annotated[
    int | None,
    typer.Option(
        "--class",
        help="Use this bar, 0 being the longest; see inspect.",
        min=0,
        show_default=False,
        rich_help_panel=_SEARCH,
    ),
]
Scale = Annotated[
    float | None,
    typer.Option(
        help="Scale of the circular coordinate, in body sizes.",
        show_default=False,
        rich_help_panel=_SEARCH,
    ),
]
Gestures = Annotated[
    bool | None,
    typer.Option(
        "--gestures/--no-gestures",
        help="Look for what recurs with something else between, or never; "
        "by default where nothing is periodic.",
        show_default=False,
        rich_help_panel=_SEARCH,
    ),
]


def search_options(
    motion: Motion,
    *,
    frames: str | None,
    joints: str | None,
    topology: dict[str, Any],
    **others: Any,
) -> Options:
    """Collect the options of the main job.

    Parameters
    ----------
    motion : Motion
        The capture they are for.
    frames, joints : str or None
        As on the command line.
    topology : dict
        Fields of `TopologyOptions`; the delay in seconds, the dimensions a number or share.
    **others
        Further fields of `Options`.
    """
    from roundelay.cloud import TopologyOptions
    from roundelay.pipeline import Options

    delay, dimensions = topology.pop("delay"), topology.pop("dimensions")
    if dimensions is not None and dimensions >= 1.0:
        dimensions = int(dimensions)
    return Options(
        frames=frame_range(frames, len(motion)),
        joints=None if joints is None else tuple(joints.split(",")),
        topology=TopologyOptions(
            delay=None if delay is None else delay * motion.fps,
            dimensions=cast("int | float | None", dimensions),
            **topology,
        ),
        **others,
    )
