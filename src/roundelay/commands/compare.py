"""``roundelay compare``: two recordings along the phase, or left and right of one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.base.files import fitting, name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
    Picture,
    echo,
    one_line_errors,
    place_of,
    print_json,
    progress_bar,
    read_capture,
)
from roundelay.commands.options import takes
from roundelay.compare.options import CompareOptions
from roundelay.formats.options import ReadOptions

if TYPE_CHECKING:
    from roundelay.compare.waveforms import Comparison
    from roundelay.cycles.cycle import Cycle
    from roundelay.motion.motion import Motion

Other = Annotated[
    Path | None,
    typer.Argument(
        metavar="OTHER",
        help="Another recording of the same skeleton; without one left is compared with right.",
        show_default=False,
    ),
]
_SUFFIXES = (".json", ".csv", ".png")


@takes(choice=CompareOptions, reading=ReadOptions)
def compare(
    capture: Capture,
    other: Other = None,
    output: Output = ".",
    picture: Picture = True,
    json: Json = False,
    *,
    choice: CompareOptions,
    reading: ReadOptions,
) -> None:
    """Compare how joints turn along the phase: two recordings, or left and right of one.

    Writes CAPTURE_compared.json, .csv (a row a joint and phase) and .png. Each recording has to
    show two whole repetitions or more of its best motion. Differences are told by permutations of
    the repetitions, for all phases and joints together.
    """
    from roundelay.base.files import written_beside
    from roundelay.output.records import capture_record, write_json

    with one_line_errors(capture):
        place = place_of(output, name_of(capture), _SUFFIXES)
        with progress_bar(quiet=json):
            motion, cycle = _recording(capture, reading)
            found = _compared(cycle, motion, other, choice, reading, name_of(capture))
        chosen = {"other": None if other is None else str(other), "level": choice.level}
        record = capture_record(motion, capture, chosen) | found.to_dict()
        write_json(record, place.path("compared", ".json"))
        with written_beside(place.path("compared", ".csv")) as part:
            part.write_text(found.to_csv(), encoding="utf-8")
        if picture:
            from roundelay.output.figures import comparison, save

            save(comparison(found), place.path("compared", ".png"))
        if json:
            print_json(record)
        else:
            _print_table(found)


def _recording(path: Path, reading: ReadOptions) -> tuple[Motion, Cycle]:
    from roundelay.pipeline import find_cycles

    motion = read_capture(path, None, reading)
    with one_line_errors(path):
        return motion, find_cycles(motion)[0]


def _compared(
    cycle: Cycle,
    motion: Motion,
    other: Path | None,
    choice: CompareOptions,
    reading: ReadOptions,
    name: str,
) -> Comparison:
    from roundelay.compare.waveforms import compare_repetitions, compare_sides
    from roundelay.cycles.repetitions import repetitions

    if other is None:
        return compare_sides(cycle, motion, choice)
    second, seen = _recording(other, reading)
    groups = repetitions(cycle, motion), repetitions(seen, second)
    labels = fitting(name, "", 40), fitting(name_of(other), "", 40)
    return compare_repetitions(*groups, choice, labels=labels)


def _print_table(found: Comparison) -> None:
    one, other = (shown(label) for label in found.labels)
    echo(f"{one} ({len(found.first)} repetitions) less {other} ({len(found.second)}), in degrees")
    echo("  joint                    mean   largest   at phase        p   differs at")
    for row in found.rows():
        spans = ", ".join(f"{start:.2f}-{stop:.2f}" for start, stop in row["differs_at"]) or "-"
        cells = f"{row['mean_difference']:+8.1f}{row['largest_difference']:+10.1f}"
        echo(f"  {row['name']:20}{cells}{row['at_phase']:11.2f}{row['p']:9.4f}   {spans}")
    for note in found.notes:
        echo(f"  {note}")
