"""``roundelay blend`` and ``roundelay transition``: mix cycles, and go from one to another."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.commands.common import one_line_errors, output_directory, read_capture
from roundelay.commands.limbs import Repair, print_limbs
from roundelay.commands.loop import Fps, InPlace, RepeatFirst

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roundelay.cycles.cycle import Cycle
    from roundelay.motion.motion import Motion

Captures = Annotated[
    list[Path],
    typer.Argument(metavar="CAPTURE", help="{readers} files, one cycle each.", show_default=False),
]
Weights = Annotated[
    str | None,
    typer.Option(help="One share a capture, with commas; equal by default.", show_default=False),
]
Align = Annotated[
    str, typer.Option(help="What agrees at equal phases: poses, or contacts of the feet.")
]
Mirror = Annotated[
    bool, typer.Option("--mirror", help="Exchange left and right where that fits better.")
]
Output = Annotated[
    Path,
    typer.Option("-o", "--output", help="File to write: {writers}.", show_default=False),
]
First = Annotated[
    Path, typer.Argument(metavar="FIRST", help="A {readers} file.", show_default=False)
]
Second = Annotated[
    Path, typer.Argument(metavar="SECOND", help="A {readers} file.", show_default=False)
]


def blend(
    captures: Captures,
    output: Output,
    weights: Weights = None,
    align: Align = "poses",
    mirror: Mirror = False,
    fps: Fps = None,
    in_place: InPlace = False,
    repeat_first: RepeatFirst = False,
    repair: Repair = True,
) -> None:
    """Blend the best cycles of several captures and write the loop.

    The cycles are brought into phase and heading with the first; rotations are averaged on the
    sphere, travel, turning and period blended along. Limbs that pass through each other more
    than in the captures are parted.
    """
    with one_line_errors():
        from roundelay.cycles.edit.blend import blend as blend_cycles
        from roundelay.cycles.edit.separate import repaired
        from roundelay.formats import write
        from roundelay.loops.profiles import limb_record

        shares = _shares(weights, len(captures))
        cycles, sources = _best_cycles(captures, mirror)
        mixed = blend_cycles(cycles, shares, by=align, mirror=mirror)  # type: ignore[arg-type]
        mixed, mended = repaired(mixed, sources) if repair else (mixed, ())
        loop = mixed.sample(fps, in_place=in_place, repeat_first=repeat_first)
        output_directory(output.parent)
        write(loop, output)
        typer.echo(f"{output}: {len(loop)} frames, period {mixed.period:.2f} s")
        print_limbs(limb_record(mixed.sample(fps), mended))


def transition(
    first: First,
    second: Second,
    output: Output,
    seconds: Annotated[float, typer.Option(help="How long the transition lasts.")] = 0.5,
    before: Annotated[float, typer.Option(help="Seconds of the first cycle before it.")] = 1.0,
    after: Annotated[float, typer.Option(help="Seconds of the second cycle after it.")] = 1.0,
    align: Align = "poses",
    mirror: Mirror = False,
    fps: Fps = None,
    repair: Repair = True,
) -> None:
    """Go from the best cycle of one capture to that of another, the phase running on."""
    with one_line_errors():
        from roundelay.cycles.edit.blend import transition as make_transition
        from roundelay.cycles.edit.separate import repaired_motion
        from roundelay.formats import write
        from roundelay.loops.profiles import limb_record

        (start, end), sources = _best_cycles([first, second], mirror)
        motion = make_transition(
            start,
            end,
            seconds,
            before=before,
            after=after,
            fps=fps,
            by=align,  # type: ignore[arg-type]
            mirror=mirror,
        )
        motion, mended = repaired_motion(motion, sources) if repair else (motion, ())
        output_directory(output.parent)
        write(motion, output)
        typer.echo(f"{output}: {len(motion)} frames at {motion.fps:.4g} fps")
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


def _shares(text: str | None, count: int) -> list[float]:
    if text is None:
        return [1.0 / count] * count
    try:
        shares = [float(part) for part in text.split(",")]
        if len(shares) != count:
            raise ValueError
    except ValueError:
        raise ValueError(
            f"expected weights as {count} numbers with commas, found {text!r}"
        ) from None
    return shares
