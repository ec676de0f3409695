"""``roundelay excitations``: the classes of a whole capture, and where each of them turns."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from roundelay.commands.common import (
    Capture,
    Directory,
    Frames,
    Json,
    Skeleton,
    frame_range,
    one_line_errors,
    output_directory,
    print_capture,
    print_json,
    read_capture,
)
from roundelay.commands.loop import Picture
from roundelay.commands.options import Joints, Metric, Prime

if TYPE_CHECKING:
    from roundelay.timeline.proposals.excitation import Excitation

Poses = Annotated[
    bool, typer.Option("--poses", help="Look at poses alone, as [A] does, without velocities.")
]
Count = Annotated[
    int | None,
    typer.Option(
        "--classes",
        help="So many; by default those that stand out from noise.",
        min=1,
        show_default=False,
    ),
]


def excitations(
    capture: Capture,
    output: Directory = Path("."),
    skeleton: Skeleton = None,
    frames: Frames = None,
    joints: Joints = None,
    metric: Metric = "euclidean",
    poses: Poses = False,
    classes: Count = None,
    prime: Prime = 47,
    picture: Picture = True,
    json: Json = False,
) -> None:
    """Show the classes of a whole capture and the frames in which the coordinate of each turns.

    Several motions in one capture are several classes, each with frames of its own ([A] 4.6).
    Writes NAME_excitations.json and NAME_excitations.png. Loops of what recurs with something
    else between are made by `roundelay loop --gestures`.
    """
    from roundelay.motion.features import point_cloud
    from roundelay.output.records import capture_record, write_json
    from roundelay.timeline.proposals.excitation import excitations as find_excitations

    with one_line_errors(capture):
        motion = read_capture(capture, skeleton).with_root_motion()
        first, last = frame_range(frames, len(motion)) or (0, len(motion))
        folder = output_directory(output)
        chosen = None if joints is None else motion.skeleton.indices(joints.split(","))
        found = find_excitations(
            point_cloud(motion, joints=chosen)[first:last],
            motion.fps,
            metric=metric,  # type: ignore[arg-type]
            period=0.0 if poses else 1.0,
            classes=classes,
            prime=prime,
        )
        options = {
            "joints": None if joints is None else joints.split(","),
            "metric": metric,
            "poses": poses,
            "classes": classes,
            "prime": prime,
        }
        record = capture_record(motion, capture, options) | {
            "frames": [first, last],
            "bars": len(found.barcode),
            "classes": [_class(one, first) for one in found.classes],
        }
        write_json(record, folder / f"{capture.stem}_excitations.json")
        if picture:
            from roundelay.output import figures

            drawn = figures.excitations(motion, found, start=first)
            figures.save(drawn, folder / f"{capture.stem}_excitations.png")
        if json:
            print_json(record)
        else:
            _print_table(record)


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
    typer.echo(
        f"  {len(record['classes'])} of {record['bars']} classes{outstanding} "
        f"in frames {first}-{last}"
    )
    typer.echo("  class   birth   death        p  regions (turns)")
    for one in record["classes"]:
        regions = ", ".join(
            f"{region['frames'][0]}-{region['frames'][1]} ({region['net_turns']:z.1f})"
            for region in one["regions"]
        )
        typer.echo(
            f"{one['class']:7d}{one['birth']:8.3f}{one['death']:8.3f}{one['p_value']:9.1e}"
            f"  {regions or '-'}"
        )
