"""``roundelay loop``: find the periodic motions of a capture and write their loops."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from roundelay.commands.common import (
    NO_PERIOD,
    Capture,
    Directory,
    Json,
    Picture,
    Skeleton,
    one_line_errors,
    output_directory,
    print_capture,
    print_json,
    progress_bar,
    read_capture,
)
from roundelay.commands.limbs import print_limbs
from roundelay.commands.options import takes
from roundelay.loops.options import LoopOptions
from roundelay.timeline.options import Options

if TYPE_CHECKING:
    from roundelay.base.errors import NoPeriod
    from roundelay.base.progress import Progress
    from roundelay.cycles.cycle import Cycle
    from roundelay.cycles.edit.separate import Mended
    from roundelay.loops.profiles import Profile
    from roundelay.motion.motion import Motion

PerBehaviour = Annotated[
    bool,
    typer.Option("--per-behaviour", help="Cut into behaviours first; loops of each by itself."),
]
Gif = Annotated[bool, typer.Option("--gif", help="Write each loop as a moving picture, too.")]


@takes(search=Options, written=LoopOptions)
def loop(
    capture: Capture,
    output: Directory = Path("."),
    skeleton: Skeleton = None,
    per_behaviour: PerBehaviour = False,
    picture: Picture = True,
    gif: Gif = False,
    json: Json = False,
    *,
    search: Options,
    written: LoopOptions,
) -> None:
    """Find the periodic motions of a capture and write a seamless loop of each.

    Writes NAME_loop.bvh (NAME_loop2.bvh, ... for further motions), NAME_loop.json and
    NAME_loop.png. Everything is automatic; the options are there to overrule it.

    Exit code 0: loops were written; 2: bad input; 3: no periodic motion was found.
    """
    from roundelay.base.errors import NoPeriod
    from roundelay.cycles.events import started
    from roundelay.loops.profiles import profiles

    with one_line_errors(capture):
        profile = profiles[written.profile]
        with progress_bar(quiet=json) as progress:
            motion = read_capture(capture, skeleton)
            folder = output_directory(output)
            try:
                cycles = _cycles(motion, search, per_behaviour, progress)
            except NoPeriod as refusal:
                _refuse(motion, capture, folder, search, refusal, json)
        cycles = [started(one, written.start) for one in cycles]
        loops = [_repaired(motion, one) if written.repair else (one, ()) for one in cycles]
        record = _write(motion, capture, folder, search, loops, written, profile, picture)
        if gif:
            _animate(record, [cycle for cycle, _ in loops], folder)
        if json:
            print_json(record)
        else:
            _print_summary(record, folder)


def _cycles(
    motion: Motion, options: Options, per_behaviour: bool, progress: Progress | None
) -> list[Cycle]:
    """Find the cycles of the whole capture, or of each of its segments."""
    from roundelay.pipeline import cycles_in_segments, find_cycles
    from roundelay.segmentation import segment

    if not per_behaviour:
        return find_cycles(motion, options, progress=progress)
    if options.frames is not None:
        raise ValueError("expected --frames or --per-behaviour, found both")
    return cycles_in_segments(segment(motion), motion, options, progress=progress)


def _repaired(motion: Motion, cycle: Cycle) -> tuple[Cycle, tuple[Mended, ...]]:
    from roundelay.cycles.edit.separate import repaired, source_parts

    return repaired(cycle, source_parts(cycle, motion))


def _refuse(
    motion: Motion,
    capture: Path,
    folder: Path,
    options: Options,
    refusal: NoPeriod,
    json: bool,
) -> None:
    from roundelay.output.records import capture_record, refusal_record, write_json

    record = capture_record(motion, capture, options) | refusal_record(refusal)
    write_json(record, folder / f"{capture.stem}_loop.json")
    if json:
        print_json(record)
        raise typer.Exit(NO_PERIOD)
    raise refusal


def _write(
    motion: Motion,
    capture: Path,
    folder: Path,
    options: Options,
    loops: list[tuple[Cycle, tuple[Mended, ...]]],
    written: LoopOptions,
    profile: Profile,
    picture: bool,
) -> dict[str, Any]:
    """Write loops, picture and record; return the record."""
    from roundelay.formats import write
    from roundelay.loops.quality import quality
    from roundelay.loops.verdict import verdict_of
    from roundelay.output.records import capture_record, cycle_record, verdict_record, write_json

    base = f"{capture.stem}_loop"
    record = capture_record(motion, capture, options) | {"sampling": asdict(written), "cycles": []}
    for number, (cycle, mended) in enumerate(loops, 1):
        path = folder / f"{base}{number if number > 1 else ''}.{written.file_format}"
        sampled = cycle.sample(**written.sampling)
        write(sampled, path)
        figures = quality(cycle, motion)
        verdict = verdict_of(cycle, motion, sampled, figures, in_place=written.in_place)
        entry = {"verdict": verdict_record(verdict, cycle)} | cycle_record(cycle, figures, [path])
        playback = profile.record(cycle, written, mended)
        record["cycles"].append(entry | {"loop_frames": len(sampled), "playback": playback})
    if picture:
        from roundelay.output.figures import overview, save

        save(overview(motion, [cycle for cycle, _ in loops]), folder / f"{base}.png")
    write_json(record, folder / f"{base}.json")
    return record


def _animate(record: dict[str, Any], cycles: list[Cycle], folder: Path) -> None:
    """Write each loop as a GIF beside its file."""
    from roundelay.output.figures import animation

    for entry, cycle in zip(record["cycles"], cycles, strict=True):
        path = folder / entry["files"][0]
        animation(cycle.sample(), path.with_suffix(".gif"))


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
            f"    -> {folder / cycle['files'][0]}: {cycle['loop_frames']} frames"
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
