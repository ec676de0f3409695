"""``roundelay convert``: from one capture format to another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from roundelay.commands.common import (
    Capture,
    Skeleton,
    one_line_errors,
    output_directory,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.loops.options import LoopOptions
from roundelay.timeline.options import Options

Target = Annotated[
    Path,
    typer.Argument(metavar="TARGET", help="The {writers} file to write.", show_default=False),
]


@takes(search=only(Options, "frames"), written=only(LoopOptions, "fps", "mirror", "resize"))
def convert(
    capture: Capture,
    target: Target,
    skeleton: Skeleton = None,
    *,
    search: Options,
    written: LoopOptions,
) -> None:
    """Convert a capture to another format, resampled, cropped, mirrored or resized.

    An AMC gets its ASF beside it, of the same name.
    """
    with one_line_errors(capture):
        from roundelay.formats import write
        from roundelay.loops.recipe import placed

        motion = read_capture(capture, skeleton)
        wanted = search.span(len(motion))
        if wanted is not None:
            motion = motion[slice(*wanted)]
        motion = placed(motion, written)
        if written.fps is not None:
            motion = motion.resample(written.fps)
        output_directory(target.parent)
        write(motion, target)
        typer.echo(f"{target}: {len(motion)} frames at {motion.fps:.4g} fps")
