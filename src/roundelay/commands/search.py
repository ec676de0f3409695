"""``roundelay search``: the cycles of a library most like that of a capture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Json,
    Skeleton,
    echo,
    one_line_errors,
    print_json,
    read_capture,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.timeline.options import Options

if TYPE_CHECKING:
    from roundelay.library import Match

Folder = Annotated[
    Path,
    typer.Argument(
        metavar="LIBRARY", help="A folder made by roundelay library.", show_default=False
    ),
]
Once = Annotated[
    bool,
    typer.Option("--once", help="Look for what is done once, in all frames or those of --frames."),
]
Count = Annotated[int, typer.Option(help="How many to list.", min=1)]


@takes(query=only(Options, "frames"), reading=ReadOptions)
def search(
    capture: Capture,
    folder: Folder,
    skeleton: Skeleton = None,
    count: Count = 10,
    once: Once = False,
    json: Json = False,
    *,
    query: Options,
    reading: ReadOptions,
) -> None:
    """List the behaviours of a library that are most like the best cycle of a capture.

    The distance is the RMS over points and phases at the best offset in phase, mirrored or not; of
    people in lengths of leg and trunk, whatever their skeletons. Behaviours of a skeleton with
    other joints are left out.

    Exit code 0: behaviours were listed; 2: bad input, or none with the capture's joints; 3: the
    capture has no periodic motion.
    """
    from roundelay.library import Library
    from roundelay.pipeline import find_cycles

    with one_line_errors(capture):
        library = Library.open(folder)
        motion = read_capture(capture, skeleton, reading)
        if once:
            start, stop = query.span(len(motion)) or (0, len(motion))
            told = f"frames {start}-{stop}"
            matches, left_out = library.search(motion[start:stop], count)
        else:
            cycle = find_cycles(motion, query)[0]
            told = f"period {cycle.period:.2f} s"
            matches, left_out = library.search(cycle, count)
        if json:
            found = [{"distance": m.distance, "file": m.file} | m.cycle for m in matches]
            print_json({"query": capture.name, "left_out": left_out, "matches": found})
        else:
            echo(f"{shown(capture.name)}: {told}")
            _print_matches(matches)
            if left_out:
                echo(f"left out, having other joints: {left_out}")


def _print_matches(matches: list[Match]) -> None:
    echo("distance  group  period  name, file: frames")
    for match in matches:
        one = match.cycle
        parts = one["parts"] if "parts" in one else [[one["start_frame"], one["end_frame"]]]
        frames = ", ".join(f"{start}-{stop}" for start, stop in parts)
        period = f"{one['period_seconds']:6.2f} s" if "period_seconds" in one else "       -"
        echo(
            f"{match.distance:8.3f}{one['group']:7d}{period}  {shown(one['name'] or '-')}, "
            f"{shown(match.file)}: {frames}"
        )
