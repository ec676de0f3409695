"""``roundelay view``: one self-contained page of a capture, its evidence and its loops."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Output,
    Skeleton,
    echo,
    one_line_errors,
    place_of,
    progress_bar,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.loops.options import LoopOptions
from roundelay.timeline.options import Options

if TYPE_CHECKING:
    from roundelay.base.progress import Progress
    from roundelay.motion.motion import Motion
    from roundelay.segmentation import Segmentation
    from roundelay.timeline.behaviours import Timeline

Open = Annotated[bool, typer.Option("--open", help="Show it in the browser.")]


@takes(search=Options, written=only(LoopOptions, "fps", "foot_lock", "repair"), reading=ReadOptions)
def view(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    open_page: Open = False,
    *,
    search: Options,
    written: LoopOptions,
    reading: ReadOptions,
) -> None:
    """Write one HTML page: the capture moving, its periodic parts, the evidence, the loops.

    The page needs no server and asks nothing of the network. A capture with no periodic motion
    gets one too, which says why.

    Exit code 0: the page was written; 2: bad input.
    """
    from roundelay.base.files import written_beside

    with one_line_errors(capture):
        name = name_of(capture)
        place = place_of(output, name, (".html",))
        with progress_bar(quiet=False) as progress:
            motion = read_capture(capture, skeleton, reading)
            text, note = _page(motion, search, written, progress)
        path = place.file or place.folder / f"{place.name}.html"
        with written_beside(path) as part:
            part.write_text(text, encoding="utf-8")
        echo(f"{shown(path)}: {note}; {len(text) / 1e3:.0f} kB")
        if open_page:
            typer.launch(path.resolve().as_uri())


def _page(
    motion: Motion, search: Options, written: LoopOptions, progress: Progress | None
) -> tuple[str, str]:
    """Return the page and what it shows in a few words."""
    from roundelay.base.errors import NoPeriod
    from roundelay.output.page import build_page
    from roundelay.pipeline import make_loops, understand

    told = understand(motion, search)
    segmentation = _segmentation(motion, told)
    try:
        loops = make_loops(motion, search, written, timeline=told, progress=progress)
    except NoPeriod as refusal:
        text = build_page(motion, refusal=refusal, segmentation=segmentation)
        return text, "no periodic motion found, the page says why"
    count = "1 periodic motion" if len(loops) == 1 else f"{len(loops)} periodic motions"
    return build_page(motion, loops, segmentation=segmentation), count


def _segmentation(motion: Motion, told: Timeline) -> Segmentation | None:
    """Cut the capture into behaviours, if it has the joints for it and is long enough."""
    from roundelay.base.errors import SkeletonMismatch, TooShort
    from roundelay.pipeline import segment

    try:
        return segment(motion, timeline=told)
    except (SkeletonMismatch, TooShort):
        return None
