"""``roundelay close``: a loop of frames that a person chose."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Directory,
    Json,
    Skeleton,
    one_line_errors,
    output_directory,
    print_json,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.loops.by_hand import CloseOptions
from roundelay.loops.options import LoopOptions
from roundelay.timeline.options import Options


@takes(
    search=only(Options, "frames"),
    closing=CloseOptions,
    written=only(LoopOptions, "file_format", "repeat_first"),
    reading=ReadOptions,
)
def close(
    capture: Capture,
    output: Directory = Path("."),
    skeleton: Skeleton = None,
    json: Json = False,
    *,
    search: Options,
    closing: CloseOptions,
    written: LoopOptions,
    reading: ReadOptions,
) -> None:
    """Make a loop of frames that do not repeat: near ends that fit are joined.

    Writes NAME_closed.bvh and NAME_closed.json. The ends of --frames are moved by up to 15 % of the
    range to where pose and speed are most alike, and what they still lack dies away behind the
    join; with --ping-pong the frames are played there and back. What repeats is for `loop`.
    """
    with one_line_errors(capture):
        from roundelay.formats import write
        from roundelay.loops.by_hand import close_by_hand
        from roundelay.output.records import capture_record, write_json

        motion = read_capture(capture, skeleton, reading)
        frames = search.span(len(motion))
        if frames is None:
            raise ValueError("expected --frames START:STOP, found none: which frames to close")
        closed = close_by_hand(motion, frames, closing)
        folder = output_directory(output)
        path = folder / f"{capture.stem}_closed.{written.file_format}"
        loop = closed.repeated() if written.first_repeated else closed.loop
        write(loop, path)
        record = capture_record(motion, capture, search) | closed.record()
        record |= {"fade": closing.fade, "files": [path.name], "loop_frames": len(loop)}
        write_json(record, folder / f"{capture.stem}_closed.json")
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
