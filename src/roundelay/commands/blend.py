"""``roundelay blend`` and ``roundelay transition``: mix cycles, and go from one to another."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.base.files import fitting, name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Captures,
    Output,
    echo,
    in_format_of,
    one_line_errors,
    place_of,
    read_capture,
)
from roundelay.commands.limbs import print_limbs
from roundelay.commands.options import all_but, only, takes
from roundelay.cycles.edit.options import AmountOptions, BlendOptions, TransitionOptions
from roundelay.formats.options import ReadOptions
from roundelay.loops.options import LoopOptions
from roundelay.retargeting.options import OntoOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roundelay.cycles.cycle import Cycle
    from roundelay.motion.motion import Motion
    from roundelay.retargeting.onto import Retargeting

First = Annotated[
    Path, typer.Argument(metavar="FIRST", help="A {readers} file.", show_default=False)
]
Second = Annotated[
    Path, typer.Argument(metavar="SECOND", help="A {readers} file.", show_default=False)
]

StylePair = Annotated[
    tuple[Path, Path] | None,
    typer.Option(
        "--style",
        metavar="STYLED NEUTRAL",
        help="Two captures whose difference is laid on the loop, such as the walk of an old man "
        "and a plain walk.",
        show_default=False,
    ),
]


@takes(
    mixing=BlendOptions,
    laid=AmountOptions,
    written=all_but(LoopOptions, "profile"),
    carrying=OntoOptions,
    reading=ReadOptions,
)
def blend(
    captures: Captures,
    output: Output,
    style: StylePair = None,
    *,
    mixing: BlendOptions,
    laid: AmountOptions,
    written: LoopOptions,
    carrying: OntoOptions,
    reading: ReadOptions,
    given: frozenset[str],
) -> None:
    """Blend the best cycles of several captures and write the loop.

    The cycles are brought into phase and heading with the first; rotations are averaged on the
    sphere, travel, turning and period blended along. Limbs that pass through each other more
    than in the captures are parted. Captures of other skeletons are carried to the first one's, or
    all to a character. In a folder the file is FIRST_blend.bvh.

    With --style the difference of two more captures is laid on it, as much as --amount says; one
    capture is then enough.
    """
    with one_line_errors():
        from roundelay.cycles.edit.blend import blend as blend_cycles
        from roundelay.cycles.edit.style import style as style_of
        from roundelay.formats import suffixes_of, writers
        from roundelay.loops.recipe import rendered

        shares = _shares(mixing, len(captures))
        place = place_of(output, name_of(captures[0]), suffixes_of(writers))
        written = in_format_of(place, written, given, captures[0], reading)
        if "amount" in given and style is None:
            raise ValueError("--amount says how much of --style, which is not given")
        several = [*captures, *(style or ())]
        cycles, sources = _best_cycles(several, mixing.mirror, reading, carrying)
        count = len(captures)
        mixed = blend_cycles(cycles[:count], shares, by=mixing.by, mirror=mixing.mirror)
        if style is not None:
            laid_on = style_of(*cycles[count:], by=mixing.by, mirror=mixing.mirror)
            mixed = laid_on.on(mixed, laid.amount)
        loop = rendered(mixed, sources, written)
        path = place.file or place.path("blend", f".{written.file_format}")
        loop.write(path)
        echo(f"{shown(path)}: {len(loop.motion)} frames, period {mixed.period:.2f} s")
        print_limbs(loop.playback)


@takes(
    joining=TransitionOptions,
    written=only(LoopOptions, "fps", "mirror", "resize", "repair", "file_format"),
    carrying=OntoOptions,
    reading=ReadOptions,
)
def transition(
    first: First,
    second: Second,
    output: Output,
    *,
    joining: TransitionOptions,
    written: LoopOptions,
    carrying: OntoOptions,
    reading: ReadOptions,
    given: frozenset[str],
) -> None:
    """Go from the best cycle of one capture to that of another, the phase running on.

    In a folder the file is FIRST_to_SECOND.bvh.
    """
    with one_line_errors():
        from roundelay.cycles.edit.blend import transition as make_transition
        from roundelay.formats import suffixes_of, write, writers
        from roundelay.loops.profiles import limb_record
        from roundelay.loops.recipe import rendered_motion

        place = place_of(output, name_of(first), suffixes_of(writers))
        written = in_format_of(place, written, given, first, reading)
        kind = f"to_{fitting(name_of(second), '', 80)}"
        path = place.file or place.path(kind, f".{written.file_format}")
        (start, end), sources = _best_cycles([first, second], joining.mirror, reading, carrying)
        motion = make_transition(start, end, **asdict(joining), fps=written.fps)
        motion, parted = rendered_motion(motion, sources, written)
        write(motion, path)
        echo(f"{shown(path)}: {len(motion)} frames at {motion.fps:.4g} fps")
        print_limbs(limb_record(motion, parted))


def _best_cycles(
    paths: Sequence[Path], mirror: bool, reading: ReadOptions, carrying: OntoOptions
) -> tuple[list[Cycle], list[Motion]]:
    """Return the best cycle of each capture, and the parts of the captures that show them.

    All are of one skeleton: that of the character, or of the first capture.
    """
    from roundelay.base.errors import NoPeriod
    from roundelay.cycles.edit.separate import source_parts
    from roundelay.pipeline import find_cycles
    from roundelay.retargeting.characters import carried_cycles

    cycles: list[Cycle] = []
    sources: list[Motion] = []
    first = None
    for path in paths:
        motion = read_capture(path, None, reading)
        try:
            cycle = find_cycles(motion)[0]
        except NoPeriod as refusal:
            raise NoPeriod(f"{path}: {refusal}", refusal.evidence) from None
        to = _carrying(motion, first, carrying)
        if to is not None:
            (cycle,), motion = carried_cycles([cycle], motion, to)
        if to is not None and carrying.onto is None and first is not None:
            told = f"{shown(path)} is carried to the skeleton of {first.name!r}"
            echo(f"roundelay: note: {told}", err=True)
        first = motion if first is None else first
        cycles.append(cycle)
        sources += source_parts(cycle, motion, mirror=mirror)
    return cycles, sources


def _carrying(motion: Motion, first: Motion | None, chosen: OntoOptions) -> Retargeting | None:
    """Return what carries a capture to the character, or to the first capture's skeleton.

    None where it has its joints already, or one of both is of points.
    """
    from roundelay.retargeting.characters import to_character
    from roundelay.retargeting.onto import Retargeting

    if chosen.onto is not None:
        return to_character(motion, chosen)
    if first is None or motion.skeleton.free or first.skeleton.free:
        return None
    ours, theirs = motion.skeleton, first.skeleton
    alike = ours.names == theirs.names and ours.parents == theirs.parents
    return None if alike else Retargeting.between(motion, first)


def _shares(mixing: BlendOptions, count: int) -> Sequence[float]:
    shares = mixing.shares or [1.0 / count] * count
    if len(shares) != count:
        raise ValueError(f"expected one share a capture, {count} in all, found {len(shares)}")
    return shares
