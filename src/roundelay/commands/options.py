"""Options of the search that several commands share: all automatic unless given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from inspect import signature
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from roundelay.commands.common import Frames, frame_range

if TYPE_CHECKING:
    from roundelay.motion.motion import Motion
    from roundelay.timeline.options import Options

__all__ = ["Joints", "Metric", "Prime", "SearchOptions", "takes_search"]

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
MaxScale = Annotated[
    float | None,
    typer.Option(
        help="Largest scale of the filtration, in body sizes: bars end there.",
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


@dataclass(frozen=True)
class SearchOptions:
    """What a user may choose of the search for periods, as on the command line."""

    frames: Frames = None
    joints: Joints = None
    features: Features = "positions"
    weights: Weights = "none"
    metric: Metric = "euclidean"
    dimensions: Dimensions = None
    delay: Delay = None
    delays: Delays = None
    prime: Prime = 47
    class_index: Class = None
    max_scale: MaxScale = None
    scale: Scale = None
    gestures: Gestures = None

    def resolved(self, motion: Motion, **others: Any) -> Options:
        """Return the options of the main job for a capture, with further fields of them."""
        from roundelay.timeline.options import Options, TopologyOptions

        axes = self.dimensions
        whole = axes is not None and axes >= 1.0 and axes.is_integer()
        return Options(
            frames=frame_range(self.frames, len(motion)),
            joints=None if self.joints is None else tuple(self.joints.split(",")),
            features=cast("Any", self.features),
            weights=cast("Any", self.weights),
            gestures=self.gestures,
            topology=TopologyOptions(
                prime=self.prime,
                class_index=self.class_index,
                max_scale=self.max_scale,
                scale=self.scale,
                delay=self.delay,
                delays=self.delays,
                metric=cast("Any", self.metric),
                dimensions=int(cast("float", axes)) if whole else axes,
            ),
            **others,
        )


def takes_search(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command an option for every field of `SearchOptions`; it gets them as `search`."""
    own = signature(command, eval_str=True)
    shared = list(signature(SearchOptions, eval_str=True).parameters.values())

    @wraps(command)
    def spread(**values: Any) -> None:
        search = SearchOptions(**{one.name: values.pop(one.name) for one in shared})
        command(**values, search=search)

    others = [one for one in own.parameters.values() if one.name != "search"]
    spread.__signature__ = own.replace(parameters=[*others, *shared])  # type: ignore[attr-defined]
    return spread
