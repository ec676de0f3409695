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
    Skeleton,
    one_line_errors,
    output_directory,
    print_capture,
    print_json,
    progress_bar,
    read_capture,
)
from roundelay.commands.limbs import Repair, print_limbs
from roundelay.commands.options import SearchOptions, takes_search

if TYPE_CHECKING:
    from roundelay.base.errors import NoPeriod
    from roundelay.base.progress import Progress
    from roundelay.cycles.cycle import Cycle
    from roundelay.cycles.edit.separate import Mended
    from roundelay.loops.profiles import Profile, Sampling
    from roundelay.motion.motion import Motion
    from roundelay.timeline.options import Options

Most = Annotated[
    int | None, typer.Option("--classes", help="At most so many loops.", min=1, show_default=False)
]
Harmonics = Annotated[
    int | None, typer.Option(help="Harmonics of the cycle.", min=1, max=500, show_default=False)
]
Method = Annotated[
    str,
    typer.Option(
        help="harmonic: a smooth regression; centroid: means of poses, as in [A]; paper: the "
        "weighted regression of [C]."
    ),
]
Velocity = Annotated[bool, typer.Option(help="Constrain the method paper by velocities, as [C].")]
Acceleration = Annotated[
    bool, typer.Option(help="Constrain the method paper by accelerations, as [C].")
]
InPlace = Annotated[
    bool, typer.Option("--in-place/--travel", help="Leave the root's travel out, or keep it.")
]
Fps = Annotated[
    float | None,
    typer.Option(help="Frame rate of the loop; the capture's by default.", show_default=False),
]
Periods = Annotated[int, typer.Option(help="Periods in the written loop.", min=1, max=1000)]
RepeatFirst = Annotated[
    bool, typer.Option("--repeat-first", help="Let the last frame repeat the first.")
]
Segments = Annotated[
    bool, typer.Option("--segments", help="Cut into behaviours first; loops of each by itself.")
]
Format = Annotated[str, typer.Option("--format", help="{formats}.")]
ProfileName = Annotated[
    str, typer.Option(help="What the record tells of playing the loop: {profiles}.")
]
Picture = Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the PNG.")]
Gif = Annotated[bool, typer.Option("--gif", help="Write each loop as a moving picture, too.")]


@takes_search
def loop(
    capture: Capture,
    output: Directory = Path("."),
    skeleton: Skeleton = None,
    classes: Most = None,
    harmonics: Harmonics = None,
    method: Method = "harmonic",
    velocity: Velocity = True,
    acceleration: Acceleration = True,
    in_place: InPlace = False,
    fps: Fps = None,
    periods: Periods = 1,
    repeat_first: RepeatFirst = False,
    segments: Segments = False,
    repair: Repair = True,
    file_format: Format = "bvh",
    profile: ProfileName = "generic",
    picture: Picture = True,
    gif: Gif = False,
    json: Json = False,
    *,
    search: SearchOptions,
) -> None:
    """Find the periodic motions of a capture and write a seamless loop of each.

    Writes NAME_loop.bvh (NAME_loop2.bvh, ... for further motions), NAME_loop.json and
    NAME_loop.png. Everything is automatic; the options are there to overrule it.

    Exit code 0: loops were written; 2: bad input; 3: no periodic motion was found.
    """
    from roundelay.base.errors import NoPeriod
    from roundelay.formats import checked_format
    from roundelay.loops.profiles import Sampling, profiles

    with one_line_errors(capture):
        checked_format(file_format)
        told = profiles[profile]
        with progress_bar(quiet=json) as progress:
            motion = read_capture(capture, skeleton)
            options = search.resolved(
                motion,
                harmonics=harmonics,
                method=method,
                velocity=velocity,
                acceleration=acceleration,
                most=classes,
            )
            folder = output_directory(output)
            try:
                cycles = _cycles(motion, options, segments, progress)
            except NoPeriod as refusal:
                _refuse(motion, capture, folder, options, refusal, json)
        sampling = Sampling(fps, periods, in_place, repeat_first)
        loops = [_repaired(motion, cycle) if repair else (cycle, ()) for cycle in cycles]
        record = _write(
            motion, capture, folder, options, loops, sampling, file_format, told, picture
        )
        if gif:
            _animate(record, [cycle for cycle, _ in loops], folder)
        if json:
            print_json(record)
        else:
            _print_summary(record, folder)


def _cycles(
    motion: Motion, options: Options, segments: bool, progress: Progress | None
) -> list[Cycle]:
    """Find the cycles of the whole capture, or of each of its segments."""
    from roundelay.pipeline import cycles_in_segments, find_cycles
    from roundelay.segmentation import segment

    if not segments:
        return find_cycles(motion, options, progress=progress)
    if options.frames is not None:
        raise ValueError("expected --frames or --segments, found both")
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
    sampling: Sampling,
    file_format: str,
    profile: Profile,
    picture: bool,
) -> dict[str, Any]:
    """Write loops, picture and record; return the record."""
    from roundelay.formats import write
    from roundelay.loops.quality import quality
    from roundelay.output.records import capture_record, cycle_record, write_json

    base = f"{capture.stem}_loop"
    record = capture_record(motion, capture, options)
    record |= {"sampling": asdict(sampling), "cycles": []}
    for number, (cycle, mended) in enumerate(loops, 1):
        path = folder / f"{base}{number if number > 1 else ''}.{file_format}"
        sampled = cycle.sample(**asdict(sampling))
        write(sampled, path)
        entry = cycle_record(cycle, quality(cycle, motion), [path])
        playback = profile.record(cycle, sampling, mended)
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
    print_capture(record["capture"])
    for number, cycle in enumerate(record["cycles"], 1):
        parts = ", ".join(f"{start}-{stop}" for start, stop in cycle["parts"])
        figures = cycle["quality"]
        typer.echo(
            f"  motion {number}: period {cycle['period_seconds']:.2f} s "
            f"({cycle['period_frames']:.1f} frames), {cycle['repetitions']:.2f} repetitions "
            f"in frames {parts}; {cycle['confidence']:.0%} sure\n"
            f"    -> {folder / cycle['files'][0]}: {cycle['loop_frames']} frames; seam "
            f"{figures['seam_rotation']:.1f} deg (largest step elsewhere "
            f"{figures['step_rotation']:.1f}), template error {figures['template_error']:.2f} rad"
        )
        print_limbs(cycle["playback"])
