"""``roundelay convert``: from one capture format to another."""

from __future__ import annotations

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
from roundelay.timeline.options import Options

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
)
def convert(
    capture: Capture,
    target: Target,
    skeleton: Skeleton = None,
    *,
    search: Options,
    written: LoopOptions,
    reading: ReadOptions,
    given: frozenset[str],
) -> None:
    """Convert a capture to another format, resampled, cropped, mirrored or resized.

    An AMC gets its ASF beside it, of the same name.
    """
    with one_line_errors(capture):
        from roundelay.formats import suffixes_of, write, writers
        from roundelay.loops.recipe import placed

        name = name_of(capture)
        place = place_of(target, name, suffixes_of(writers))
        written = in_format_of(place, written, given, capture, reading)
        path = place.file or place.folder / f"{place.name}.{written.file_format}"
        motion = read_capture(capture, skeleton, reading)
        wanted = search.span(len(motion))
        if wanted is not None:
            motion = motion[slice(*wanted)]
        motion = placed(motion, written)
        if written.fps is not None:
            motion = motion.resample(written.fps)
        write(motion, path)
        echo(f"{shown(path)}: {len(motion)} frames at {motion.fps:.4g} fps")
