"""``roundelay blend`` and ``roundelay transition``: mix cycles, and go from one to another."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.commands.common import one_line_errors, output_directory, read_capture
from roundelay.commands.loop import Fps, InPlace, RepeatFirst

if TYPE_CHECKING:
    from roundelay.cycles.cycle import Cycle

Captures = Annotated[
    list[Path], typer.Argument(help="BVH or AMC files, one cycle each.", show_default=False)
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
    typer.Option(
        "-o", "--output", help="File to write: BVH, AMC, GLB or GLTF.", show_default=False
    ),
]
Capture = Annotated[Path, typer.Argument(help="A BVH or AMC file.", show_default=False)]


def blend(
    captures: Captures,
    output: Output,
    weights: Weights = None,
    align: Align = "poses",
    mirror: Mirror = False,
    fps: Fps = None,
    in_place: InPlace = False,
    repeat_first: RepeatFirst = False,
) -> None:
    """Blend the best cycles of several captures and write the loop.

    The cycles are brought into phase and heading with the first; rotations are averaged on the
    sphere, travel, turning and period blended along.
    """
    with one_line_errors():
        from roundelay.cycles.blend import blend as blend_cycles
        from roundelay.formats import write

        cycles = [_best_cycle(path) for path in captures]
        shares = [1.0 / len(cycles)] * len(cycles) if weights is None else _numbers(weights)
        mixed = blend_cycles(cycles, shares, by=align, mirror=mirror)  # type: ignore[arg-type]
        loop = mixed.sample(fps, in_place=in_place, repeat_first=repeat_first)
        output_directory(output.parent)
        write(loop, output)
        typer.echo(f"{output}: {len(loop)} frames, period {mixed.period:.2f} s")


def transition(
    first: Capture,
    second: Capture,
    output: Output,
    seconds: Annotated[float, typer.Option(help="How long the transition lasts.")] = 0.5,
    before: Annotated[float, typer.Option(help="Seconds of the first cycle before it.")] = 1.0,
    after: Annotated[float, typer.Option(help="Seconds of the second cycle after it.")] = 1.0,
    align: Align = "poses",
    mirror: Mirror = False,
    fps: Fps = None,
) -> None:
    """Go from the best cycle of one capture to that of another, the phase running on."""
    with one_line_errors():
        from roundelay.cycles.blend import transition as make_transition
        from roundelay.formats import write

        motion = make_transition(
            _best_cycle(first),
            _best_cycle(second),
            seconds,
            before=before,
            after=after,
            fps=fps,
            by=align,  # type: ignore[arg-type]
            mirror=mirror,
        )
        output_directory(output.parent)
        write(motion, output)
        typer.echo(f"{output}: {len(motion)} frames at {motion.fps:g} fps")


def _best_cycle(path: Path) -> Cycle:
    from roundelay.errors import NoPeriod
    from roundelay.pipeline import find_cycles

    try:
        return find_cycles(read_capture(path, None))[0]
    except NoPeriod as refusal:
        raise NoPeriod(f"{path}: {refusal}", refusal.evidence) from None


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ValueError(f"expected numbers with commas, found {text!r}") from None
