"""``roundelay blend`` and ``roundelay transition``: mix cycles, and go from one to another."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.commands.common import File, one_line_errors, output_directory, read_capture
from roundelay.commands.limbs import print_limbs
from roundelay.commands.options import all_but, only, takes
from roundelay.cycles.edit.options import BlendOptions, TransitionOptions
from roundelay.loops.options import LoopOptions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roundelay.cycles.cycle import Cycle
    from roundelay.motion.motion import Motion

Captures = Annotated[
    list[Path],
    typer.Argument(metavar="CAPTURE", help="{readers} files, one cycle each.", show_default=False),
]
First = Annotated[
    Path, typer.Argument(metavar="FIRST", help="A {readers} file.", show_default=False)
]
Second = Annotated[
    Path, typer.Argument(metavar="SECOND", help="A {readers} file.", show_default=False)
]


@takes(mixing=BlendOptions, written=all_but(LoopOptions, "file_format", "profile"))
def blend(captures: Captures, file: File, *, mixing: BlendOptions, written: LoopOptions) -> None:
    """Blend the best cycles of several captures and write the loop.

    The cycles are brought into phase and heading with the first; rotations are averaged on the
    sphere, travel, turning and period blended along. Limbs that pass through each other more
    than in the captures are parted.
    """
    with one_line_errors():
        from roundelay.cycles.edit.blend import blend as blend_cycles
        from roundelay.cycles.edit.separate import repaired
        from roundelay.cycles.events import started
        from roundelay.formats import write, writer_of
        from roundelay.loops.profiles import limb_record

        writer_of(file)  # refuses a suffix that none knows, before the work
        written = replace(written, file_format=file.suffix[1:].lower())
        shares = _shares(mixing, len(captures))
        cycles, sources = _best_cycles(captures, mixing.mirror)
        mixed = blend_cycles(cycles, shares, by=mixing.by, mirror=mixing.mirror)
        mixed = started(mixed, written.start)
        mixed, mended = repaired(mixed, sources) if written.repair else (mixed, ())
        loop = mixed.sample(**written.sampling)
        output_directory(file.parent)
        write(loop, file)
        typer.echo(f"{file}: {len(loop)} frames, period {mixed.period:.2f} s")
        parted = mixed.sample(written.fps, foot_lock=written.foot_lock)
        print_limbs(limb_record(parted, mended))


@takes(joining=TransitionOptions, written=only(LoopOptions, "fps", "repair"))
def transition(
    first: First,
    second: Second,
    file: File,
    *,
    joining: TransitionOptions,
    written: LoopOptions,
) -> None:
    """Go from the best cycle of one capture to that of another, the phase running on."""
    with one_line_errors():
        from roundelay.cycles.edit.blend import transition as make_transition
        from roundelay.cycles.edit.separate import repaired_motion
        from roundelay.formats import write
        from roundelay.loops.profiles import limb_record

        (start, end), sources = _best_cycles([first, second], joining.mirror)
        motion = make_transition(start, end, **asdict(joining), fps=written.fps)
        motion, mended = repaired_motion(motion, sources) if written.repair else (motion, ())
        output_directory(file.parent)
        write(motion, file)
        typer.echo(f"{file}: {len(motion)} frames at {motion.fps:.4g} fps")
        print_limbs(limb_record(motion, mended))


def _best_cycles(paths: Sequence[Path], mirror: bool) -> tuple[list[Cycle], list[Motion]]:
    """Return the best cycle of each capture, and the parts of the captures that show them."""
    from roundelay.base.errors import NoPeriod
    from roundelay.cycles.edit.separate import source_parts
    from roundelay.pipeline import find_cycles

    cycles, sources = [], []
    for path in paths:
        motion = read_capture(path, None)
        try:
            cycles.append(find_cycles(motion)[0])
        except NoPeriod as refusal:
            raise NoPeriod(f"{path}: {refusal}", refusal.evidence) from None
        sources += source_parts(cycles[-1], motion, mirror=mirror)
    return cycles, sources


def _shares(mixing: BlendOptions, count: int) -> Sequence[float]:
    shares = mixing.shares or [1.0 / count] * count
    if len(shares) != count:
        raise ValueError(f"expected one share a capture, {count} in all, found {len(shares)}")
    return shares
