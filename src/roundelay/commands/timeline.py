"""``roundelay timeline``: what repeats in a whole take, limb by limb, and how sure that is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Json,
    Output,
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
from roundelay.timeline.options import Options

if TYPE_CHECKING:
    from roundelay.timeline.behaviours import Behaviour, Timeline


_SUFFIXES = (".json", ".csv")
_OPTIONS = ("frames", "joints", "proposers", "uncertain")


@takes(search=only(Options, *_OPTIONS), reading=ReadOptions)
def timeline(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    json: Json = False,
    *,
    search: Options,
    reading: ReadOptions,
) -> None:
    """Tell what repeats in a whole take, limb by limb, and how sure that is.

    Writes NAME_timeline.json and NAME_timeline.csv (a row a stretch, times in seconds). Every
    repetition is predicted by the others; what is told is more likely than not, and no limb is
    in two behaviours at the same time. Where nothing repeats, a take whose ends meet is told as
    one closed pass.

    Exit code 0: the take was looked at, also if nothing repeats; 2: bad input.
    """
    from roundelay.base.files import written_beside
    from roundelay.output.records import capture_record, write_json
    from roundelay.pipeline import understand

    with one_line_errors(capture):
        with progress_bar(quiet=json) as progress:
            motion = read_capture(capture, skeleton, reading)
            place = place_of(output, name_of(capture), _SUFFIXES)
            told = understand(motion, search, progress=progress)
        chosen = {name: getattr(search, name) for name in _OPTIONS}
        record = capture_record(motion, capture, chosen) | told.to_dict()
        write_json(record, place.path("timeline", ".json"))
        with written_beside(place.path("timeline", ".csv")) as part:
            part.write_text(told.to_csv(), encoding="utf-8")
        if json:
            print_json(record)
        else:
            _print_table(told, capture, search.uncertain)


def _print_table(told: Timeline, capture: Path, uncertain: bool) -> None:
    seconds = told.n_frames / told.fps
    echo(f"{shown(capture.name)}: {told.n_frames} frames, {seconds:.1f} s; {', '.join(told.limbs)}")
    listed = [*told.behaviours, *(told.uncertain if uncertain else ())]
    if not listed:
        echo(f"  nothing repeats: {told.reason}")
        return
    echo("  kind     period  times   sure  limbs; frames")
    for each in listed:
        echo(_row(each))
        if each.phrase is not None:
            echo(_row(each.phrase).replace("cyclic", "phrase"))


def _row(each: Behaviour) -> str:
    from roundelay.timeline.behaviours import ASIDE

    period = "-" if each.kind in ASIDE else f"{each.period:.2f} s"
    times = f"{each.repetitions:.1f}" if each.kind == "cyclic" else "-"
    sure = "-" if each.probability is None else f"{each.probability:.0%}"
    limbs = "all" if each.whole else " + ".join(each.limbs)
    return f"  {each.kind:8}{period:>7}{times:>7}{sure:>7}  {limbs}; {each.spans}"
