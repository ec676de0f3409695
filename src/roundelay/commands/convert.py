"""``roundelay convert``: from one capture format to another."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Skeleton,
    echo,
    in_format_of,
    one_line_errors,
    place_of,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.loops.options import LoopOptions
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points
from roundelay.solving.options import SolvingOptions
from roundelay.timeline.options import Options

# Options that change points, so that gaps have to be filled.
_CHANGES = frozenset({"fps", "mirror", "resize", "fill-gaps", "max-gap"})
Target = Annotated[
    str,
    typer.Argument(
        metavar="TARGET",
        help="The {writers} file to write; or a folder for one of --format, named as the capture.",
        show_default=False,
    ),
]


@takes(
    search=only(Options, "frames"),
    written=only(LoopOptions, "fps", "mirror", "resize", "file_format"),
    reading=ReadOptions,
    solving=SolvingOptions,
)
def convert(
    capture: Capture,
    target: Target,
    skeleton: Skeleton = None,
    *,
    search: Options,
    written: LoopOptions,
    reading: ReadOptions,
    solving: SolvingOptions,
    given: frozenset[str],
) -> None:
    """Convert a capture to another format, resampled, cropped, mirrored or resized.

    An AMC gets its ASF beside it, of the same name. Markers and keypoints become a skeleton with
    turning bones where a format of skeletons is written; where one of points is, gaps stay gaps
    unless --max-gap or another change is asked for.
    """
    with one_line_errors(capture):
        from roundelay.formats import suffixes_of, write, writers
        from roundelay.loops.recipe import placed

        name = name_of(capture)
        place = place_of(target, name, suffixes_of(writers))
        written = in_format_of(place, written, given, capture, reading)
        path = place.file or place.folder / f"{place.name}.{written.file_format}"
        if _keeps_gaps(capture, path, reading, given):
            points = _points(capture, search, reading)
            write(points, path)
            echo(f"{shown(path)}: {len(points)} frames at {points.fps:.4g} fps")
            return
        if not solving.points and _needs_bones(capture, path, reading):
            motion = _solved(capture, search, reading)
        else:
            motion = read_capture(capture, skeleton, reading)
            motion = motion[_frames(search, len(motion))]
        motion = placed(motion, written)
        if written.fps is not None:
            motion = motion.resample(written.fps)
        write(motion, path)
        echo(f"{shown(path)}: {len(motion)} frames at {motion.fps:.4g} fps")


def _keeps_gaps(capture: Path, path: Path, reading: ReadOptions, given: frozenset[str]) -> bool:
    """Tell whether points go from a file of points to another as they are."""
    from roundelay.formats.registry import PointsReader, PointsWriter, reader_of, writer_of

    reader, writer = reader_of(capture, reading.suffix), writer_of(path)
    of_points = isinstance(reader, PointsReader) and isinstance(writer, PointsWriter)
    return of_points and not given & _CHANGES


def _needs_bones(capture: Path, path: Path, reading: ReadOptions) -> bool:
    """Tell whether a file of points shall go into a format of skeletons."""
    from roundelay.formats.registry import PointsReader, PointsWriter, reader_of, writer_of

    reader, writer = reader_of(capture, reading.suffix), writer_of(path)
    return isinstance(reader, PointsReader) and not isinstance(writer, PointsWriter)


def _solved(capture: Path, search: Options, reading: ReadOptions) -> Motion:
    """Read points and solve their skeleton."""
    from roundelay.solving import solve_skeleton

    return solve_skeleton(_points(capture, search, reading))


def _points(capture: Path, search: Options, reading: ReadOptions) -> Points:
    """Read points as they are, at the rate and of the frames that are asked for."""
    from roundelay.formats import read_points

    points = read_points(capture, suffix=reading.suffix)
    if reading.capture_fps is not None:
        points = replace(points, fps=reading.capture_fps)
    return points[_frames(search, len(points))]


def _frames(search: Options, count: int) -> slice:
    """Return the frames that are asked for, of so many."""
    return slice(*(search.span(count) or (0, count)))
