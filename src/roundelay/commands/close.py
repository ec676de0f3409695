"""``roundelay close``: a loop of frames that a person chose."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import typer

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
    Skeleton,
    in_format_of,
    one_line_errors,
    place_of,
    print_json,
    read_capture,
    refuse_over,
)
from roundelay.commands.options import all_but, only, takes
from roundelay.formats.options import ReadOptions
from roundelay.loops.by_hand import CloseOptions
from roundelay.loops.options import LoopOptions
from roundelay.timeline.options import Options

_NOT_TAKEN = ("start", "mirror", "resize", "foot_lock", "repair", "profile")


@takes(
    search=only(Options, "frames"),
    closing=CloseOptions,
    written=all_but(LoopOptions, *_NOT_TAKEN),
    reading=ReadOptions,
)
def close(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    json: Json = False,
    *,
    search: Options,
    closing: CloseOptions,
    written: LoopOptions,
    reading: ReadOptions,
    given: frozenset[str],
) -> None:
    """Make a loop of frames that do not repeat: near ends that fit are joined.

    Writes NAME_closed.bvh and NAME_closed.json, or names as -o says. The ends of --frames are moved
    by up to 15 % of the range to where pose and speed are most alike. What they still lack dies
    away behind the join. With --ping-pong the frames are played there and back. What repeats is for
    `loop`.
    """
    with one_line_errors(capture):
        from roundelay.formats import files_written, suffixes_of, write, writers
        from roundelay.loops.by_hand import close_by_hand
        from roundelay.output.records import capture_record, write_json

        place = place_of(output, name_of(capture), suffixes_of(writers))
        refuse_over(capture, place)
        written = in_format_of(place, written, given, capture, reading)
        motion = read_capture(capture, skeleton, reading)
        frames = search.span(len(motion))
        if frames is None:
            raise ValueError("expected --frames START:STOP, found none: which frames to close")
        closed = close_by_hand(motion, frames, closing)
        path = place.path("closed", f".{written.file_format}")
        loop = closed.exported(written)
        write(loop, path)
        files = [file.name for file in files_written(path)]
        record = capture_record(motion, capture, search) | closed.record()
        record |= {"fade": closing.fade, "sampling": asdict(written), "files": files}
        record["loop_frames"] = len(loop)
        write_json(record, place.path("closed", ".json"))
        if json:
            print_json(record)
        else:
            typer.echo(_summary(record, path))


def _summary(record: dict[str, Any], path: Path) -> str:
    (first, last), (start, stop) = record["asked"], record["frames"]
    how = "there and back" if record["ping_pong"] else "its ends joined"
    return (
        f"{shown(record['capture']['file'])}: closed by hand, {how}: frames {start}-{stop} of "
        f"{first}-{last} asked for, {record['period_seconds']:.2f} s, joints turned by up to "
        f"{record['largest_degrees']:.0f} degrees\n"
        f"  -> {shown(path)}: {record['loop_frames']} frames"
    )
