"""``roundelay inspect``: the classes behind the automatic choice, as table, JSON and picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from roundelay.base.files import name_of
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
    Picture,
    Skeleton,
    echo,
    one_line_errors,
    place_of,
    print_capture,
    print_json,
    progress_bar,
    read_capture,
)
from roundelay.commands.options import all_but, takes
from roundelay.formats.options import ReadOptions
from roundelay.timeline.options import Options, ShownOptions

if TYPE_CHECKING:
    from roundelay.timeline.evidence import Evidence
    from roundelay.timeline.inspection import Inspection


_SUFFIXES = (".json", ".png")


@takes(
    search=all_but(Options, "classes", "method", "harmonics", "velocity", "acceleration"),
    shown=ShownOptions,
    reading=ReadOptions,
)
def inspect(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    picture: Picture = True,
    json: Json = False,
    *,
    search: Options,
    shown: ShownOptions,
    reading: ReadOptions,
) -> None:
    """Show the barcode of every motion and the coordinate of each of its classes.

    Writes NAME_inspect.json and NAME_inspect.png. A class, a scale or frames that serve better
    than the automatic choice can be given to `roundelay loop` by the options of the same names.
    Periods are those of the coordinates; that of a loop is refined by its poses.

    Exit code 0: there are candidates, periodic or not; 2: bad input; 3: no pose comes back.
    """
    from roundelay.timeline.inspection import inspect as inspect_motion

    with one_line_errors(capture):
        with progress_bar(quiet=json):
            motion = read_capture(capture, skeleton, reading)
            place = place_of(output, name_of(capture), _SUFFIXES)
            most = {} if shown.classes is None else {"most": shown.classes}
            found = inspect_motion(motion, search, **most)
        record = _record(motion, capture, search, found)
        from roundelay.output.records import write_json

        write_json(record, place.path("inspect", ".json"))
        if picture:
            from roundelay.output.figures import inspection, save

            save(inspection(motion, found), place.path("inspect", ".png"))
        if json:
            print_json(record)
        else:
            print_capture(record["capture"])
            for number, item in enumerate(found, 1):
                _print_table(number, item, motion.fps)


def _record(
    motion: Any, capture: Path, options: Options, found: list[Inspection]
) -> dict[str, Any]:
    from roundelay.output.records import capture_record, evidence_record

    motions = [
        {
            "objection": item.objection or None,
            "components": len(item.evidence.barcode.components) + 1,
            "classes": [
                {
                    "class": one.index,
                    "birth": one.birth,
                    "death": one.death,
                    "p_value": one.p_value,
                    "fault": one.fault or None,
                    "coordinate": None if one.evidence is None else evidence_record(one.evidence),
                }
                for one in item.classes
            ],
        }
        for item in found
    ]
    return capture_record(motion, capture, options) | {"motions": motions}


def _print_table(number: int, item: Inspection, fps: float) -> None:
    parts = ", ".join(f"{start}-{stop}" for start, stop in item.evidence.runs)
    echo(f"  motion {number}: frames {parts}" + (f" ({item.objection})" if item.objection else ""))
    if item.evidence.aligned:
        echo("  no class turns with the repetitions: their alignment is the phase")
    heading = ("class", "birth", "death", "p", "turns", "forward", "period s", "scale")
    echo("  " + "".join(f"{title:>10}" for title in heading))
    for one in item.classes:
        cells = [f"{one.index}", f"{one.birth:.4f}", f"{one.death:.4f}", f"{one.p_value:.1e}"]
        cells += [] if one.evidence is None else _motion_cells(one.evidence, fps)
        own, aligned = item.evidence.coordinate.class_index, item.evidence.aligned
        used = one.index == own and not aligned
        remark = "  <- loop" if used else f"  {one.fault}"
        echo("  " + "".join(f"{cell:>10}" for cell in cells) + remark.rstrip())


def _motion_cells(evidence: Evidence, fps: float) -> list[str]:
    return [
        f"{evidence.net:.2f}",
        f"{evidence.steadiness:.2f}",
        f"{evidence.period / fps:.2f}",
        f"{evidence.coordinate.scale:.4f}",
    ]
