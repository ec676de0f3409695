"""``roundelay reproduce``: the methods of the papers to the letter, on one capture."""

from __future__ import annotations

from typing import Any

from roundelay.base.errors import TooShort
from roundelay.base.files import name_of
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
    Skeleton,
    echo,
    one_line_errors,
    place_of,
    print_capture,
    print_json,
    read_capture,
)
from roundelay.commands.options import all_but, only, takes
from roundelay.formats.options import ReadOptions
from roundelay.reproduction.options import ExtractionOptions, TrajectoryOptions
from roundelay.timeline.options import Options

# Finite differences of 9 frames, of more than one.
_FEWEST = 16


@takes(
    search=only(Options, "frames"),
    trajectory=TrajectoryOptions,
    extraction=all_but(ExtractionOptions, "prime"),
    reading=ReadOptions,
)
def reproduce(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    json: Json = False,
    *,
    search: Options,
    trajectory: TrajectoryOptions,
    extraction: ExtractionOptions,
    reading: ReadOptions,
) -> None:
    """Measure what [A] and [C] tell of a capture in their tables, by their own methods.

    Of [A] the row of table 1: birth of the class, simplices, seconds. Of [C] those of tables A and
    B: template and root mean squared errors of M1, M2, M3, and of what it discusses: complete
    periods, correlated errors, ridge, reweighting. Writes NAME_papers.json. The methods of [B] are
    those of `roundelay segment --cut-by ppca-paper`. For loops use `roundelay loop`.
    """
    from roundelay.output.records import capture_record, write_json
    from roundelay.reproduction.rows import extraction_rows, trajectory_row

    with one_line_errors(capture):
        motion = read_capture(capture, skeleton, reading)
        place = place_of(output, name_of(capture), (".json",))
        first, last = search.span(len(motion)) or (0, len(motion))
        if last - first < _FEWEST:
            raise TooShort(f"expected at least {_FEWEST} frames, found {last - first}")
        chosen = motion[first:last]
        options = {"frames": [first, last], "[A]": _told(trajectory), "[C]": _told(extraction)}
        record = capture_record(motion, capture, options) | {
            "[A]": trajectory_row(chosen, trajectory),
            "[C]": extraction_rows(chosen, extraction),
        }
        write_json(record, place.path("papers", ".json"))
        if json:
            print_json(record)
        else:
            _print(record)


def _told(options: Any) -> dict[str, Any]:
    from roundelay.base.options import declared

    return {one.name: getattr(options, one.name) for one in declared(type(options))}


def _print(record: dict[str, Any]) -> None:
    print_capture(record["capture"])
    echo(f"  [A] table 1: {_in_words(record['[A]'])}")
    for name, row in record["[C]"].items():
        echo(f"  [C] {name}: {_in_words(row)}")


def _in_words(row: dict[str, Any]) -> str:
    if "failed" in row:
        return row["failed"]
    return ", ".join(f"{key} {_shown(value)}" for key, value in row.items() if value is not None)


def _shown(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, list):
        return " ".join(map(_shown, value))
    return str(value) if isinstance(value, int) else f"{value:.4g}"
