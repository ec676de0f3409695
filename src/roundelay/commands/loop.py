"""``roundelay loop``: find the periodic motions of a capture and write their loops."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    BAD_INPUT,
    NO_PERIOD,
    Json,
    Output,
    Picture,
    Place,
    Skeleton,
    Timetable,
    exit_code,
    in_format_of,
    one_line_errors,
    place_of,
    print_capture,
    print_json,
    progress_bar,
    read_capture,
    refuse_over,
    table_of,
)
from roundelay.commands.limbs import print_limbs
from roundelay.commands.options import takes
from roundelay.formats.options import ReadOptions
from roundelay.loops.options import LoopOptions
from roundelay.retargeting.options import OntoOptions
from roundelay.timeline.options import Options

if TYPE_CHECKING:
    from roundelay.base.progress import Progress
    from roundelay.cycles.cycle import Cycle
    from roundelay.loops.recipe import Loop
    from roundelay.motion.motion import Motion
    from roundelay.studio.work import Work

PerBehaviour = Annotated[
    bool,
    typer.Option("--per-behaviour", help="Cut into behaviours first; loops of each by itself."),
]
FromWork = Annotated[
    Path | None,
    typer.Option(
        "--work",
        help="Work of the studio, NAME.work.json: it names its capture, which lies beside it, and "
        "all options.",
        show_default=False,
    ),
]
Taken = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="CAPTURE",
        help="{readers} files, as they are or packed (.gz); - for standard input, see --as.",
        show_default=False,
    ),
]
Gif = Annotated[bool, typer.Option("--gif", help="Write each loop as a moving picture, too.")]


@dataclass(frozen=True)
class _Asked:
    """What was asked of every capture."""

    search: Options
    written: LoopOptions
    reading: ReadOptions
    carrying: OntoOptions
    skeleton: Path | None
    per_behaviour: bool
    timeline: Path | None
    picture: bool
    gif: bool
    json: bool
    work: Work | None = None


@takes(search=Options, written=LoopOptions, carrying=OntoOptions, reading=ReadOptions)
def loop(
    captures: Taken = None,
    output: Output = ".",
    skeleton: Skeleton = None,
    per_behaviour: PerBehaviour = False,
    timeline: Timetable = None,
    work: FromWork = None,
    picture: Picture = True,
    gif: Gif = False,
    json: Json = False,
    *,
    search: Options,
    written: LoopOptions,
    carrying: OntoOptions,
    reading: ReadOptions,
    given: frozenset[str],
) -> None:
    """Find the periodic motions of captures and write a seamless loop of each.

    Writes NAME_loop.bvh (NAME_loop2.bvh, ... for further motions), NAME_loop.json and
    NAME_loop.png, or names as -o says; what an earlier run left there under such names, as its
    record lists it, and this one did not make is removed. Everything is automatic; the options are
    there to overrule it: with --timeline loops are made of the behaviours that a table names, with
    --work of those that a person chose in the studio.

    Exit code 0: loops were written; 2: bad input; 3: no periodic motion was found. Of several
    captures the worst counts, 2 being worse than 3.
    """
    captures = captures or []
    with one_line_errors():
        done = None
        if work is not None:
            sources = [*captures, timeline, skeleton, *(f"--{flag}" for flag in sorted(given))]
            done = _read_work(work, [str(one) for one in sources if one is not None])
            captures, written = [done.path], done.render
        elif not captures:
            raise ValueError("expected a CAPTURE, or --work, found neither; see loop --help")
        places = _places(captures, output)
        written = in_format_of(places[0], written, given, captures[0], reading)
    asked = _Asked(
        search,
        written,
        reading,
        carrying,
        skeleton,
        per_behaviour,
        timeline,
        picture,
        gif,
        json,
        done,
    )
    records: list[dict[str, Any]] = []
    codes = [
        exit_code(partial(_looped, capture, place, asked, records))
        for capture, place in zip(captures, places, strict=True)
    ]
    if json and records:
        print_json(records[0] if len(captures) == 1 else records)
    raise typer.Exit(max(codes, key=(0, NO_PERIOD, BAD_INPUT).index))


def _read_work(path: Path, others: Sequence[str]) -> Work:
    """Read the work of the studio, which says everything itself."""
    from roundelay.studio.work import read_work

    if others:
        raise ValueError(f"expected --work alone, for it names its capture and its options, found "
                         f"{others[0]}, too")  # fmt: skip
    return read_work(path)


def _places(captures: Sequence[Path], output: str) -> list[Place]:
    """Tell where the loops of each capture go.

    Raises
    ------
    ValueError
        If those of two would go to the same files, or over a capture.
    """
    from roundelay.formats import suffixes_of, writers

    names = [name_of(capture) for capture in captures]
    places = [place_of(output, name, suffixes_of(writers)) for name in names]
    if len(captures) > 1 and places[0].file is not None:
        raise ValueError(f"expected a folder for {len(captures)} captures, found {output!r}")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"expected captures of different names, found {twice!r} twice")
    refuse_over(captures[0], places[0])
    return places


def _looped(capture: Path, place: Place, asked: _Asked, records: list[dict[str, Any]]) -> None:
    """Make, write and tell the loops of a capture; add its record."""
    from roundelay.base.errors import NoPeriod
    from roundelay.output.records import capture_record, refusal_record

    with one_line_errors(capture):
        with progress_bar(quiet=asked.json) as progress:
            motion = _read(capture, asked)
            options = asked.search if asked.work is None else asked.work.to_dict()
            record = capture_record(motion, capture, options)
            if asked.carrying.onto is not None:
                record["onto"] = asdict(asked.carrying)
            try:
                loops, shown_motion = _loops(motion, asked, progress)
            except NoPeriod as refusal:
                records.append(record | refusal_record(refusal))
                _leave_record(records[-1], place, capture)
                if asked.json:
                    raise typer.Exit(NO_PERIOD) from None
                raise
        record |= {
            "sampling": asdict(asked.written),
            "cycles": _written(loops, place, asked.written, asked.gif),
            "picture": _drawn(shown_motion, loops, place) if asked.picture else None,
        }
        _leave_record(record, place, capture)
        records.append(record)
        if not asked.json:
            _print_summary(record, place.folder)


def _read(capture: Path, asked: _Asked) -> Motion:
    if asked.work is not None:
        return asked.work.motion()
    return read_capture(capture, asked.skeleton, asked.reading)


def _loops(motion: Motion, asked: _Asked, progress: Progress | None) -> tuple[list[Loop], Motion]:
    """Make the loops of the whole capture, of each of its behaviours, or those of a work.

    The capture is returned, too; both are on the character, if one is asked for.
    """
    from roundelay.loops.recipe import made_loop, numbered

    if asked.work is not None:
        from roundelay.studio.making import loops_of

        own = replace(asked.work, render=asked.written)
        return loops_of(own, motion, progress=progress), motion
    cycles = _cycles(motion, asked, progress)
    if asked.carrying.onto is not None:
        from roundelay.retargeting.characters import carried_cycles, to_character

        cycles, motion = carried_cycles(cycles, motion, to_character(motion, asked.carrying))
    return [made_loop(cycle, motion, asked.written) for cycle in numbered(cycles)], motion


def _cycles(motion: Motion, asked: _Asked, progress: Progress | None) -> list[Cycle]:
    from roundelay.pipeline import cycles_in_segments, find_cycles, segment

    table = asked.timeline
    if table is None and not asked.per_behaviour:
        return find_cycles(motion, asked.search, progress=progress)
    if asked.search.frames is not None:
        option = "--per-behaviour" if table is None else "--timeline"
        raise ValueError(f"expected --frames or {option}, found both")
    found = segment(motion) if table is None else table_of(table, motion)
    return cycles_in_segments(found, motion, asked.search, progress=progress)


def _written(
    loops: Sequence[Loop], place: Place, written: LoopOptions, gif: bool
) -> list[dict[str, Any]]:
    """Write the loops, as moving pictures too if asked; return their records."""
    from roundelay.output.records import loop_record

    told = []
    for number, one in enumerate(loops, 1):
        ending = str(number) if number > 1 else ""
        files = [*one.write(place.path("loop", f".{written.file_format}", ending))]
        if gif:
            from roundelay.output.figures import animation

            files.append(files[0].with_suffix(".gif"))
            animation(one.cycle.sample(), files[-1])
        told.append(loop_record(one, files))
    return told


def _drawn(motion: Motion, loops: Sequence[Loop], place: Place) -> str:
    """Draw the capture with its loops; return the picture's name."""
    from roundelay.output.figures import overview, save

    path = place.path("loop", ".png")
    save(overview(motion, [one.cycle for one in loops]), path)
    return path.name


def _leave_record(record: dict[str, Any], place: Place, capture: Path) -> None:
    """Write a record; remove what the one before it lists and this one does not."""
    from roundelay.output.records import write_json

    path = place.path("loop", ".json")
    own, kept = re.compile(re.escape(path.stem) + r"\d*\.\w+"), _files_of(record)
    # What was named by hand is left to who named it.
    for name in _listed(path) if place.file is None else ():
        old = place.folder / name
        if own.fullmatch(name) and name not in kept and old.resolve() != capture.resolve():
            old.unlink(missing_ok=True)
    write_json(record, path)


def _listed(path: Path) -> list[str]:
    """List the files that a record of loops names; none if it is no such record."""
    try:
        return _files_of(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return []


def _files_of(record: dict[str, Any]) -> list[str]:
    """List the loops and the picture that a record names."""
    files = [name for cycle in record["cycles"] for name in cycle["files"]]
    return [str(name) for name in (*files, record.get("picture")) if name is not None]


def _print_summary(record: dict[str, Any], folder: Path) -> None:
    from roundelay.loops.verdict import Verdict

    print_capture(record["capture"])
    for number, cycle in enumerate(record["cycles"], 1):
        parts = ", ".join(f"{start}-{stop}" for start, stop in cycle["parts"])
        verdict = cycle["verdict"]
        told = Verdict(verdict["word"], tuple(verdict["reasons"]))
        typer.echo(
            f"  motion {number}: {told}\n"
            f"    period {cycle['period_seconds']:.2f} s ({cycle['period_frames']:.1f} frames), "
            f"{cycle['repetitions']:.2f} repetitions in frames {parts}; "
            f"{_certainty(cycle)}; {_told_speed(verdict)}\n"
            f"    -> {shown(folder / cycle['files'][0])}: {cycle['loop_frames']} frames"
        )
        print_limbs(cycle["playback"])


def _certainty(cycle: dict[str, Any]) -> str:
    """Say how sure it is that a motion repeats, and which limbs do if not all."""
    if cycle["kind"] == "closed":
        return "one pass whose ends meet"
    sure = f"{cycle['confidence']:.0%} sure"
    doubtful = ", rather not" if cycle["confidence"] < 0.5 else ""
    return sure + doubtful + (f"; {' + '.join(cycle['limbs'])} alone" if cycle["limbs"] else "")


def _told_speed(verdict: dict[str, Any]) -> str:
    from roundelay.loops.units import Lengths

    if not verdict["travels"]:
        return "stays in place"
    return Lengths(verdict["body_size"], verdict["metres_a_unit"]).told_speed(verdict["speed"])
