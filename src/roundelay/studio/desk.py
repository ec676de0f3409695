"""What the process of the studio does with takes: open them, make loops, export them.

Every job is a generator of events, each a piece of plain data that the browser gets at once: the
take plays before it is searched, a loop plays before it is judged.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from roundelay.base.errors import NoPeriod, TooShort
from roundelay.base.progress import Progress, report
from roundelay.base.texts import shown
from roundelay.cycles.cycle import Cycle
from roundelay.loops.options import LoopOptions
from roundelay.loops.recipe import Loop, made_loop, numbered
from roundelay.motion.motion import Motion
from roundelay.output.figures.palette import phase_colours
from roundelay.output.figures.space import Space
from roundelay.output.page.capture import capture_data
from roundelay.output.page.packing import Packer
from roundelay.pipeline import understand
from roundelay.studio.choices import class_choices, period_choices
from roundelay.studio.export import write_zip
from roundelay.studio.making import cycle_of, motions_of, part_of, rendered_as
from roundelay.studio.shown import loop_event, verdict_event
from roundelay.studio.words import as_command, as_python
from roundelay.studio.work import Part, Work, checksum
from roundelay.timeline.behaviours import Timeline
from roundelay.timeline.by_hand import groups_of

__all__ = ["Desk"]

# Takes that are kept at hand.
_KEPT = 3
Event = dict[str, Any]


class Desk:
    """Hold the takes that were opened last, with what is known of them.

    Parameters
    ----------
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.
    """

    def __init__(self, progress: Progress | None = None) -> None:
        self._takes: dict[tuple[str, str], _Take] = {}
        self.progress = progress

    def open(self, path: str, work: Any = None) -> Iterator[Event]:
        """Open a take, and its work if it has one; then make and judge its loops.

        Parameters
        ----------
        path : str
        work : dict, optional
            As `Work.to_dict` tells it.

        Yields
        ------
        dict
            ``take``, then ``work``, then of every part what `remake` yields.

        Raises
        ------
        FormatError
            If the take cannot be read.
        ValueError
            If the work is none, or that of another file.
        """
        report(self.progress, 0.0, "reading")
        take = self._take(path)
        yield {"take": take.packed()}
        known = None if work is None else self._checked(work, take)
        told = take.told(self.progress)
        own = known or _new_work(take, told)
        yield {
            "work": own.to_dict(),
            "motions": len(motions_of(told)),
            "reason": told.reason,
            "limbs": list(groups_of(take.motion)),
        } | _words(own, told)
        yield from self._loops(take, own, range(len(own.parts)))

    def remake(self, path: str, work: Any, places: list[int]) -> Iterator[Event]:
        """Make the loops of some parts of a work.

        Parameters
        ----------
        path : str
        work : dict
        places : list of int
            Of the parts, 0 being the first.

        Yields
        ------
        dict
            ``words``; of every part ``loop``, as soon as it can play; later ``loop`` and
            ``verdict``, of what is written. ``fault`` tells of a part that shows no loop.
        """
        take = self._take(path)
        own = self._checked(work, take)
        yield _words(own, take.told(self.progress))
        yield from self._loops(take, own, [place for place in places if place < len(own.parts)])

    def choices(self, path: str, work: Any, place: int) -> Iterator[Event]:
        """Tell which periods and classes a part may have.

        Yields
        ------
        dict
            ``choices``: a list of periods, and of classes with the turns of each.
        """
        take = self._take(path)
        part = self._checked(work, take).parts[place]
        told = take.told(self.progress)
        cycle = take.cycle(part, self.progress)
        yield {
            "choices": {
                "place": place,
                "periods": period_choices(told, part, cycle),
                "classes": class_choices(cycle),
            }
        }

    def export(self, path: str, work: Any, target: str | None, archive: str) -> Iterator[Event]:
        """Write the loops of a work as one program plays them, into a zip.

        Parameters
        ----------
        path : str
        work : dict
        target : str, optional
            As `LoopOptions.target` names it; None for the work's own.
        archive : str
            The zip.

        Yields
        ------
        dict
            ``exported``: the names of the files in the zip.
        """
        take = self._take(path)
        own = self._checked(work, take)
        if target is not None:
            own = replace(own, render=_retargeted(own.render, target))
        take.told(self.progress)
        loops = [self._loop(take, own, place) for place in range(len(own.parts))]
        report(self.progress, 0.9, "packing")
        yield {"exported": write_zip(own, take.motion, loops, Path(archive))}

    def _take(self, path: str) -> _Take:
        key = path, checksum(Path(path))
        if key not in self._takes:
            self._takes[key] = _Take(Path(path), key[1])
            self._takes = dict(list(self._takes.items())[-_KEPT:])
        return self._takes[key]

    def _checked(self, work: Any, take: _Take) -> Work:
        """Make the work of plain data, and check that it is that of the take."""
        own = Work.of_dict(work, take.path.parent)
        if (own.capture, own.checksum) != (take.path.name, take.checksum):
            raise ValueError(
                f"expected the work of {take.path.name}, found that of {own.capture}, or the file "
                "is another one now"
            )
        return own

    def _loops(self, take: _Take, own: Work, places: Any) -> Iterator[Event]:
        """Let all loops play first; then judge them."""
        playing = []
        for place in places:
            report(self.progress, 0.7, f"making {own.parts[place].name}")
            try:
                cycle = take.cycle(own.parts[place], self.progress)
            except (NoPeriod, TooShort, ValueError) as error:
                yield {"fault": str(error), "place": place}
                continue
            playing.append(place)
            yield loop_event(take.motion, cycle, take.space, place)
        for place in playing:
            report(self.progress, 0.9, f"judging {own.parts[place].name}")
            loop = self._loop(take, own, place)
            yield loop_event(take.motion, loop.cycle, take.space, place, loop.render)
            yield verdict_event(loop, place)

    def _loop(self, take: _Take, own: Work, place: int) -> Loop:
        # Named by its place, as all loops of the take are.
        report(self.progress, 0.8, f"making {own.parts[place].name}")
        return take.loop(own.parts[place], place, own.render, self.progress)


@dataclass(eq=False)
class _Take:
    """A take, with what was found in it so far."""

    path: Path
    checksum: str
    _told: Timeline | None = None
    _cycles: dict[Part, Cycle] = field(default_factory=dict)
    _loops: dict[tuple[Part, int, LoopOptions], Loop] = field(default_factory=dict)

    @cached_property
    def motion(self) -> Motion:
        from roundelay.formats import read

        return read(self.path)

    @cached_property
    def space(self) -> Space:
        return Space.of(self.motion)

    def packed(self) -> str:
        packer = Packer()
        return packer.text({
            "name": shown(self.path.name),
            "colours": phase_colours(64),
            "capture": capture_data(self.motion, self.space, packer),
        })  # fmt: skip

    def told(self, progress: Progress | None) -> Timeline:
        if self._told is None:
            part = progress and (lambda done, stage: progress(0.1 + 0.6 * done, stage))
            self._told = understand(self.motion, progress=part)
        return self._told

    def cycle(self, part: Part, progress: Progress | None) -> Cycle:
        key = replace(part, name="", start=0.0)
        if key not in self._cycles:
            self._cycles[key] = cycle_of(part, self.motion, self.told(progress))
        return self._cycles[key]

    def loop(self, part: Part, place: int, render: LoopOptions, progress: Progress | None) -> Loop:
        render = rendered_as(render, part)
        key = replace(part, name=""), place, render
        if key not in self._loops:
            cycle = self.cycle(part, progress)
            named = numbered([cycle] * (place + 1))[place]
            self._loops[key] = made_loop(named, self.motion, render)
        return self._loops[key]


def _new_work(take: _Take, told: Timeline) -> Work:
    """Take all that was found as it is."""
    parts = (part_of(number, one) for number, one in enumerate(motions_of(told), 1))
    return Work(take.path.name, take.checksum, len(take.motion), tuple(parts))


def _words(own: Work, told: Timeline) -> Event:
    motions = len(motions_of(told))
    words = {"command": as_command(own, motions), "python": as_python(own, motions)}
    return {"words": words}


def _retargeted(render: LoopOptions, target: str) -> LoopOptions:
    """Return how a program plays it; what a person asked for that fits every program stays."""
    usual = LoopOptions()
    kept = ("fps", "periods", "in_place", "mirror", "resize", "foot_lock", "repair")
    own = {k: getattr(render, k) for k in kept if getattr(render, k) != getattr(usual, k)}
    return LoopOptions(target=target, **own)  # type: ignore[arg-type]
