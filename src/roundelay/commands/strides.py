"""``roundelay strides``: when feet come down and leave, and strides with their spread."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
    Picture,
    Skeleton,
    echo,
    one_line_errors,
    place_of,
    print_json,
    progress_bar,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.gait.options import StrideOptions
from roundelay.timeline.options import Options

if TYPE_CHECKING:
    from roundelay.gait.result import Strides

_SUFFIXES = (".json", ".csv", ".png")


@takes(choice=StrideOptions, search=only(Options, "frames"), reading=ReadOptions)
def strides(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    picture: Picture = True,
    json: Json = False,
    *,
    choice: StrideOptions,
    search: Options,
    reading: ReadOptions,
) -> None:
    """Tell when each foot comes down and leaves the ground, and the strides between.

    Writes NAME_strides.json, NAME_strides.csv (a row a stride) and NAME_strides.png. Steps are
    told of two feet or more pairs, over ground, on a treadmill, backward; where the legs repeat
    what they do, unless --everywhere. Means have an interval by a block bootstrap.

    Exit code 0: there are steps; 2: bad input, or no feet; 3: no gait.
    """
    from roundelay.base.files import written_beside
    from roundelay.gait.strides import strides as strides_of
    from roundelay.output.records import capture_record, write_json

    with one_line_errors(capture):
        with progress_bar(quiet=json) as progress:
            motion = read_capture(capture, skeleton, reading)
            place = place_of(output, name_of(capture), _SUFFIXES)
            told = strides_of(motion, choice, search=search, progress=progress)
        chosen = {"rule": choice.rule, "everywhere": choice.everywhere, "frames": search.frames}
        record = capture_record(motion, capture, chosen) | told.to_dict()
        write_json(record, place.path("strides", ".json"))
        with written_beside(place.path("strides", ".csv")) as part:
            part.write_text(told.to_csv(), encoding="utf-8")
        if picture:
            from roundelay.output.figures import save, steps

            save(steps(told), place.path("strides", ".png"))
        if json:
            print_json(record)
        else:
            _print_table(told, capture)


def _print_table(told: Strides, capture: Path) -> None:
    ground = "on a belt or in place" if told.ground == "belt" else "over ground"
    way = "backward" if told.backward else "forward"
    echo(f"{shown(capture.name)}: {len(told.strides)} strides in frames {told.spans}")
    echo(f"  {way}, {ground}; moments by {told.rule}")
    echo("  foot        quantity            mean       SD     CV   interval of the mean")
    for foot, summary in told.summary.items():
        for name, one in summary.items():
            unit = f"{name.replace('_', ' ')} {told.unit_of(name)}".strip()
            cells = [_number(one.mean, "9.3f"), _number(one.sd, "9.3f"), _number(one.cv, "7.1%")]
            sure = f"{one.low:.3f} to {one.high:.3f}" if isfinite(one.low) else "-"
            echo(f"  {foot:12}{unit:16}{''.join(cells)}   {sure}")
    for name in ("time", "length", "stance"):
        for pair in told.differences[name]:
            if isfinite(pair.difference):
                sure = f", {pair.low:.3f} to {pair.high:.3f}" if isfinite(pair.low) else ""
                echo(f"  {pair.left} - {pair.right}: {name} {pair.difference:+.3f}{sure}")
    for note in told.notes:
        echo(f"  {note}")


def _number(value: float, form: str) -> str:
    width = int(form.partition(".")[0])
    return f"{value:{form}}" if isfinite(value) else f"{'-':>{width}}"
