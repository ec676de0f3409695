"""``roundelay excitations``: the classes of a whole capture, and where each of them turns."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

from roundelay.base.files import name_of
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
    Picture,
    Skeleton,
    echo,
    one_line_errors,
    place_of,
    print_capture,
    print_json,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.timeline.options import Options, ShownOptions

if TYPE_CHECKING:
    from roundelay.base.spans import Span
    from roundelay.motion.motion import Motion
    from roundelay.timeline.proposals.excitation import Excitation, Excitations


_SUFFIXES = (".json", ".png")


@takes(
    search=only(Options, "frames", "joints", "metric", "delay", "prime"),
    shown=ShownOptions,
    reading=ReadOptions,
)
def excitations(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    picture: Picture = True,
    json: Json = False,
    *,
    search: Options,
    shown: ShownOptions,
    reading: ReadOptions,
) -> None:
    """Show the classes of a whole capture and the frames in which the coordinate of each turns.

    Several motions in one capture are several classes, each with frames of its own ([A] 4.6).
    Writes NAME_excitations.json and NAME_excitations.png. Loops of what recurs, with or without
    something else between, are made by `roundelay loop`.
    """
    from roundelay.output.records import capture_record, write_json

    with one_line_errors(capture):
        motion = read_capture(capture, skeleton, reading).with_root_motion()
        first, last = _looked_at(motion, search)
        place = place_of(output, name_of(capture), _SUFFIXES)
        options = {
            "joints": search.joints,
            "metric": search.topology.metric,
            "delay": search.topology.delay,
            "classes": shown.classes,
            "prime": search.topology.prime,
        }
        found = _found(motion, first, last, options)
        record = capture_record(motion, capture, options) | {
            "frames": [first, last],
            "bars": len(found.barcode),
            "classes": [_class(one, first) for one in found.classes],
        }
        write_json(record, place.path("excitations", ".json"))
        if picture:
            from roundelay.output import figures

            drawn = figures.excitations(motion, found, start=first)
            figures.save(drawn, place.path("excitations", ".png"))
        if json:
            print_json(record)
        else:
            _print_table(record)


def _looked_at(motion: Motion, search: Options) -> Span:
    """Return the frames to look at.

    Raises
    ------
    TooShort
        If they are fewer than any period.
    """
    from roundelay.base.errors import TooShort
    from roundelay.timeline.thresholds import SEARCH

    first, last = search.span(len(motion)) or (0, len(motion))
    if last - first < SEARCH.fewest:
        told = f"a period needs at least {SEARCH.fewest} frames, found {last - first}"
        raise TooShort(told)
    return first, last


def _found(motion: Motion, first: int, last: int, options: dict[str, Any]) -> Excitations:
    """Find the classes of these frames and where each turns, by the options of the record."""
    from roundelay.motion.features import point_cloud
    from roundelay.timeline.proposals.excitation import excitations as find_excitations

    joints, delay = options["joints"], options["delay"]
    chosen = None if joints is None else motion.skeleton.indices(joints)
    return find_excitations(
        point_cloud(motion, joints=chosen)[first:last],
        motion.fps,
        metric=options["metric"],
        **({} if delay is None else {"period": 2.0 * pi * delay}),
        classes=options["classes"],
        prime=options["prime"],
    )


def _class(one: Excitation, first: int) -> dict[str, Any]:
    return {
        "class": one.coordinate.class_index,
        "birth": one.coordinate.birth,
        "death": one.coordinate.death,
        "p_value": one.p_value,
        "regions": [
            {
                "frames": [first + region.start, first + region.stop],
                "net_turns": region.net,
                "total_turns": region.total,
            }
            for region in one.regions
        ],
    }


def _print_table(record: dict[str, Any]) -> None:
    print_capture(record["capture"])
    first, last = record["frames"]
    outstanding = " stand out" if record["options"]["classes"] is None else ""
    echo(
        f"  {len(record['classes'])} of {record['bars']} classes{outstanding} "
        f"in frames {first}-{last}"
    )
    echo("  class   birth   death        p  regions (turns)")
    for one in record["classes"]:
        regions = ", ".join(
            f"{region['frames'][0]}-{region['frames'][1]} ({region['net_turns']:z.1f})"
            for region in one["regions"]
        )
        echo(
            f"{one['class']:7d}{one['birth']:8.3f}{one['death']:8.3f}{one['p_value']:9.1e}"
            f"  {regions or '-'}"
        )
