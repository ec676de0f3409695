"""``roundelay convert``: from one capture format to another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from roundelay.commands.common import (
    Capture,
    Frames,
    Skeleton,
    frame_range,
    one_line_errors,
    output_directory,
    read_capture,
)

Target = Annotated[
    Path,
    typer.Argument(metavar="TARGET", help="The {writers} file to write.", show_default=False),
]
Fps = Annotated[float | None, typer.Option(help="Resample to this rate.", show_default=False)]
Scale = Annotated[float, typer.Option(help="Multiply every length.")]


def convert(
    capture: Capture,
    target: Target,
    skeleton: Skeleton = None,
    frames: Frames = None,
    fps: Fps = None,
    scale: Scale = 1.0,
) -> None:
    """Convert a capture to another format, resampled, cropped or scaled.

    An AMC gets its ASF beside it, of the same name.
    """
    with one_line_errors(capture):
        from roundelay.formats import write

        motion = read_capture(capture, skeleton)
        wanted = frame_range(frames, len(motion))
        if wanted is not None:
            motion = motion[slice(*wanted)]
        if scale != 1.0:
            motion = motion.scaled(scale)
        if fps is not None:
            motion = motion.resample(fps)
        output_directory(target.parent)
        write(motion, target)
        typer.echo(f"{target}: {len(motion)} frames at {motion.fps:.4g} fps")
