"""One recipe: a cycle becomes a loop, repaired, sampled, measured, judged and written."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from roundelay.base.checks import chosen, expected
from roundelay.base.errors import RoundelayWarning
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.align import mapped, mirrored
from roundelay.cycles.edit.separate import Mended, repaired, repaired_motion, source_parts
from roundelay.cycles.events import begun, started
from roundelay.formats import files_written, write
from roundelay.loops.exported import exported
from roundelay.loops.lint import odd_rate
from roundelay.loops.options import LoopOptions
from roundelay.loops.profiles import profiles
from roundelay.loops.quality import Quality, quality
from roundelay.loops.verdict import Verdict, verdict_of
from roundelay.motion.motion import Motion

__all__ = ["Loop", "Rendered", "made_loop", "numbered", "placed", "rendered", "rendered_motion"]

_Placed = TypeVar("_Placed", Cycle, Motion)


@dataclass(frozen=True, eq=False, repr=False)
class Rendered:
    """Hold a cycle as it is written.

    Attributes
    ----------
    cycle : Cycle
        Mirrored, resized and its limbs parted, as the options ask.
    motion : Motion
        The frames that a file of the options' format holds.
    playback : dict
        What the program that plays the loop is told, by the options' profile.
    parted : tuple of Mended
        Limbs that were moved apart.
    render : LoopOptions
        How it was made.
    """

    cycle: Cycle
    motion: Motion
    playback: dict[str, Any]
    parted: tuple[Mended, ...]
    render: LoopOptions

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.cycle!r}, {len(self.motion)} frames)"

    def write(self, path: str | PathLike[str]) -> tuple[Path, ...]:
        """Write the loop in the format that the file's suffix names.

        The last frame repeats the first if the options ask for it, or players of the format need
        it. The file appears whole or not at all.

        Parameters
        ----------
        path : path-like
            Without a suffix it gets that of the options' format.

        Returns
        -------
        tuple of Path
            The files written: an AMC has its ASF beside it.

        Raises
        ------
        ValueError
            If the suffix is not known.
        OSError
            If a file cannot be written.
        """
        path = Path(path)
        path = path if path.suffix else path.with_suffix(f".{self.render.file_format}")
        write(self._in_format(path.suffix[1:].lower()), path)
        return files_written(path)

    def _in_format(self, file_format: str) -> Motion:
        """Return the frames of a file in a format."""
        other = self.render.in_format(file_format)
        if (other.sampling, other.unit) == (self.render.sampling, self.render.unit):
            return self.motion
        return exported(self.cycle, other)


@dataclass(frozen=True, eq=False, repr=False)
class Loop(Rendered):
    """Hold a loop that was made from a capture, and what is to be known of it.

    Attributes
    ----------
    quality : Quality
        Its figures beside those of the capture.
    verdict : Verdict
        Whether it can be used, and if not why.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> loop = rl.make_loops(walk)[0]
    >>> loop.verdict.word, len(loop.motion)
    ('good', 66)
    """

    quality: Quality
    verdict: Verdict


@one_thread
def made_loop(cycle: Cycle, capture: Motion, render: LoopOptions | None = None) -> Loop:
    """Make the loop of a cycle that was found in a capture.

    `roundelay.make_loops` finds the cycles, too.

    Parameters
    ----------
    cycle : Cycle
        As from `roundelay.find_cycles`.
    capture : Motion
        The capture given to it.
    render : LoopOptions, optional
        How it is repaired, sampled and written.

    Raises
    ------
    SkeletonMismatch
        If it shall be mirrored, and a joint of one side has no partner on the other.
    ValueError
        If the cycle carries no evidence of where it was found.
    """
    render, capture = chosen(LoopOptions, render), expected(Motion, capture)
    sources = source_parts(expected(Cycle, cycle), capture)
    capture = placed(capture, render)
    found, plain = _rendered(cycle, sources, render, capture)
    figures = quality(found.cycle, capture)
    verdict = verdict_of(
        found.cycle,
        capture,
        plain,
        figures,
        in_place=bool(render.in_place),
        resized=render.resize,
    )
    _tell_odd_rate(found)
    return Loop(**vars(found), quality=figures, verdict=verdict)


def numbered(cycles: Sequence[Cycle]) -> list[Cycle]:
    """Name the cycles of one capture as the files of their loops are told apart."""
    named = [
        (cycle, cycle.name if n == 1 else f"{cycle.name}_loop{n}")
        for n, cycle in enumerate(cycles, 1)
    ]
    return [replace(cycle, name=name) for cycle, name in named]


def _tell_odd_rate(found: Rendered) -> None:
    """Warn of a gait too slow or too fast for a person: the capture's frame rate may be wrong."""
    fault = odd_rate(found.motion, found.render.first_repeated)
    if fault is not None:
        warnings.warn(
            f"{found.cycle.name}: {fault.says} ({fault.value:.2f} s); if the capture's frame rate "
            "is wrong, read it with the true one (--capture-fps on the command line)",
            RoundelayWarning,
            stacklevel=3,
        )


@one_thread
def rendered(cycle: Cycle, sources: Sequence[Motion], render: LoopOptions) -> Rendered:
    """Make a loop of a cycle that no capture shows as it is, such as a blend.

    Parameters
    ----------
    cycle : Cycle
    sources : sequence of Motion
        What it is made from: two bones may be as deep in each other as they are there.
    render : LoopOptions

    Raises
    ------
    SkeletonMismatch
        If it shall be mirrored, and a joint of one side has no partner on the other.
    """
    return _rendered(cycle, sources, render)[0]


def _rendered(
    cycle: Cycle, sources: Sequence[Motion], render: LoopOptions, capture: Motion | None = None
) -> tuple[Rendered, Motion]:
    """Return also the frames in the capture's world; the capture is placed already."""
    cycle = started(placed(cycle, render), render.start, capture)
    parted: tuple[Mended, ...] = ()
    if render.repair:
        cycle, parted = repaired(cycle, [placed(each, render) for each in sources])
    playback = profiles[render.profile].record(cycle, render, parted)
    plain = cycle.sample(**render.sampling)
    return Rendered(cycle, exported(cycle, render, plain), playback, parted, render), plain


@one_thread
def rendered_motion(
    motion: Motion, sources: Sequence[Motion], render: LoopOptions
) -> tuple[Motion, tuple[Mended, ...]]:
    """Return a motion that does not loop, such as a transition, as it is written.

    Parameters and errors are those of `rendered`.

    Returns
    -------
    motion : Motion
    parted : tuple of Mended
        Limbs that were moved apart.
    """
    motion = placed(motion, render)
    if not render.repair:
        return motion, ()
    return repaired_motion(motion, [placed(each, render) for each in sources])


def placed(taken: _Placed, render: LoopOptions) -> _Placed:
    """Return a cycle or a motion mirrored and resized as the options ask.

    Raises
    ------
    SkeletonMismatch
        If it shall be mirrored, and a joint of one side has no partner on the other.
    """
    if render.mirror:
        # A mirrored gait begins with the other foot.
        taken = begun(mirrored(taken)) if isinstance(taken, Cycle) else taken.mirror()
    if render.resize != 1.0:
        by = render.resize
        taken = _resized(taken, by) if isinstance(taken, Cycle) else taken.scaled(by)
    return taken


def _resized(cycle: Cycle, factor: float) -> Cycle:
    """Return a cycle with every length multiplied by a factor."""
    moved, above = cycle.translations, cycle.above
    return replace(
        cycle,
        skeleton=cycle.skeleton.scaled(factor),
        velocity=mapped(cycle.velocity, lambda v: v * factor),
        height=mapped(cycle.height, lambda v: v * factor),
        translations=None if moved is None else mapped(moved, lambda v: v * factor),
        above=above and replace(above, places=above.places * factor),
    )
