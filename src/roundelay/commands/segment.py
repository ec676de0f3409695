"""``roundelay segment``: cut a capture into behaviours."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
    Picture,
    Place,
    Skeleton,
    echo,
    one_line_errors,
    place_of,
    print_json,
    progress_bar,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.segmentation.options import SegmentOptions
from roundelay.timeline.options import Options

if TYPE_CHECKING:
    from roundelay.motion.motion import Motion
    from roundelay.segmentation import Segmentation

Split = Annotated[bool, typer.Option("--split", help="Write each segment as a BVH of its own.")]


_SUFFIXES = (".json", ".csv", ".png")


@takes(search=only(Options, "joints"), cut=SegmentOptions, reading=ReadOptions)
def segment(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    split: Split = False,
    picture: Picture = True,
    json: Json = False,
    *,
    search: Options,
    cut: SegmentOptions,
    reading: ReadOptions,
) -> None:
    """Cut a capture into behaviours, and name those that come back alike.

    Writes NAME_segments.json, NAME_segments.csv (a bout table: start and end in seconds, label,
    score) and NAME_segments.png; with --split also NAME_segment01.bvh and so on. Of each
    segment it is told whether it repeats itself, and with what period.

    Exit code 0: the capture was cut, perhaps into one segment; 2: bad input.
    """
    from roundelay.pipeline import segment as cut_motion

    with one_line_errors(capture):
        with progress_bar(quiet=json) as progress:
            motion = read_capture(capture, skeleton, reading)
            place = place_of(output, name_of(capture), _SUFFIXES)
            found = cut_motion(motion, method=cut.chosen, joints=search.joints, progress=progress)
        record = _write(found, motion, capture, place, split, picture)
        if json:
            print_json(record)
        else:
            _print_table(found, capture)


def _write(
    found: Segmentation, motion: Motion, capture: Path, place: Place, split: bool, picture: bool
) -> dict[str, Any]:
    """Write record, bout table, picture and clips; return the record."""
    from roundelay.base.files import written_beside
    from roundelay.formats import write
    from roundelay.output.records import write_json

    record = found.to_dict() | {"source": capture.name, "files": []}
    if split:
        digits = max(2, len(str(len(found))))
        for number, clip in enumerate(found.clips(motion), 1):
            path = place.path("segment", ".bvh", f"{number:0{digits}d}")
            write(clip, path)
            record["files"].append(path.name)
    with written_beside(place.path("segments", ".csv")) as part:
        part.write_text(found.to_csv(), encoding="utf-8")
    if picture:
        from roundelay.output.figures import save
        from roundelay.output.figures.timeline import timeline

        save(timeline(found), place.path("segments", ".png"))
    write_json(record, place.path("segments", ".json"))
    return record


def _print_table(found: Segmentation, capture: Path) -> None:
    behaviours = len({segment.label for segment in found.segments})
    seconds = found.n_frames * found.frame_time
    echo(
        f"{shown(capture.name)}: {found.n_frames} frames, {seconds:.1f} s; "
        f"{_counted(len(found), 'segment')}, {_counted(behaviours, 'behaviour')}"
    )
    echo("    start      end  seconds  label  score  period      frames")
    for row in found.bouts():
        score = "-" if row["score"] is None else f"{row['score']:.2f}"
        period = "-" if row["period"] is None else f"{row['period']:.2f} s"
        echo(
            f"{row['start']:9.2f}{row['end']:9.2f}{row['seconds']:9.2f}{row['label']:7d}"
            f"{score:>7}{period:>8}  {row['start_frame']:6d}-{row['end_frame']}"
        )


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" + ("" if count == 1 else "s")
