"""``roundelay convert``: from one capture format to another."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import typer

from roundelay.base.options import Checked, option
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


@dataclass(frozen=True)
class ConvertOptions(Checked):
    """Choices of a conversion.

    Parameters
    ----------
    resize : float
        Factor of every length.
    """

    title: ClassVar[str] = "What is changed"

    resize: float = option(1.0, "Multiply every length by this.", above=0)


@takes(search=only(Options, "frames"), written=only(LoopOptions, "fps"), change=ConvertOptions)
def convert(
    capture: Capture,
    target: Target,
    skeleton: Skeleton = None,
    *,
    search: Options,
    written: LoopOptions,
    change: ConvertOptions,
) -> None:
    """Convert a capture to another format, resampled, cropped or scaled.

    An AMC gets its ASF beside it, of the same name.
    """
    with one_line_errors(capture):
        from roundelay.formats import write

        motion = read_capture(capture, skeleton)
        wanted = search.span(len(motion))
        if wanted is not None:
            motion = motion[slice(*wanted)]
        if change.resize != 1.0:
            motion = motion.scaled(change.resize)
        if written.fps is not None:
            motion = motion.resample(written.fps)
        output_directory(target.parent)
        write(motion, target)
        typer.echo(f"{target}: {len(motion)} frames at {motion.fps:.4g} fps")
