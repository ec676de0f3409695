"""``roundelay vary``: a loop of repetitions that differ as those of the capture do."""

from __future__ import annotations

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Output,
    Skeleton,
    echo,
    in_format_of,
    one_line_errors,
    place_of,
    progress_bar,
    read_capture,
    refuse_over,
)
from roundelay.commands.options import only, takes
from roundelay.cycles.edit.options import VaryOptions
from roundelay.formats.options import ReadOptions
from roundelay.loops.options import LoopOptions
from roundelay.retargeting.options import OntoOptions

__all__ = ["vary"]


@takes(
    drawing=VaryOptions,
    written=only(
        LoopOptions,
        "fps",
        "in_place",
        "repeat_first",
        "mirror",
        "resize",
        "foot_lock",
        "file_format",
    ),
    carrying=OntoOptions,
    reading=ReadOptions,
)
def vary(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    *,
    drawing: VaryOptions,
    written: LoopOptions,
    carrying: OntoOptions,
    reading: ReadOptions,
    given: frozenset[str],
) -> None:
    """Make a loop that does not look looped: repetitions drawn as those of the capture vary.

    Writes NAME_varied.bvh, or names as -o says. Each period is a new one with its own pace; after
    the last the first comes again, without a seam. The capture has to show at least two whole
    repetitions of its best motion.
    """
    with one_line_errors(capture):
        from roundelay.cycles.repetitions import repetitions
        from roundelay.formats import suffixes_of, write, writers
        from roundelay.loops.recipe import placed
        from roundelay.pipeline import find_cycles

        place = place_of(output, name_of(capture), suffixes_of(writers))
        refuse_over(capture, place)
        written = in_format_of(place, written, given, capture, reading)
        with progress_bar(quiet=False) as progress:
            motion = read_capture(capture, skeleton, reading, carrying)
            cycle = find_cycles(motion, progress=progress)[0]
        own = repetitions(placed(cycle, written), placed(motion, written))
        made = own.vary(
            drawing.repetitions,
            rng=drawing.seed,
            amount=drawing.amount,
            fps=written.fps,
            in_place=bool(written.in_place),
            repeat_first=written.first_repeated,
            foot_lock=written.foot_lock,
        )
        path = place.path("varied", f".{written.file_format}")
        write(made, path)
        echo(
            f"{shown(path)}: {drawing.repetitions} periods drawn from {len(own)} repetitions, "
            f"{len(made)} frames at {made.fps:.4g} fps"
        )
