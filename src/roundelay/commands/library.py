"""``roundelay library``: cut, label, loop and index all captures below a folder."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.base.texts import shown
from roundelay.commands.common import (
    BAD_INPUT,
    INTERRUPTED,
    NO_PERIOD,
    Directory,
    Json,
    echo,
    fail,
    one_line_errors,
    print_json,
)
from roundelay.commands.options import all_but, takes
from roundelay.loops.options import LoopOptions

if TYPE_CHECKING:
    from roundelay.base.progress import Progress
    from roundelay.library import Library
    from roundelay.library.workers import Limits

Sources = Annotated[
    list[Path],
    typer.Argument(
        metavar="FOLDER|FILE",
        help="Folders, searched to any depth for {readers} files, or such files.",
        show_default=False,
    ),
]
Jobs = Annotated[
    int | None,
    typer.Option(help="Processes; one a CPU by default.", min=1, show_default=False),
]
Seconds = Annotated[
    float,
    typer.Option("--clip-seconds", help="Most seconds that a clip is given.", min=1.0),
]
Memory = Annotated[
    int | None,
    typer.Option(
        "--clip-memory",
        help="Most megabytes of addresses that a clip is given; not on Windows.",
        min=1,
        show_default=False,
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="A Dask scheduler, tcp://..., whose workers do the clips.",
        show_default=False,
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        "--cluster", help="Do the clips by so many Dask workers here.", min=1, show_default=False
    ),
]
Again = Annotated[bool, typer.Option("--again", help="Do again what an earlier run did.")]


@takes(written=all_but(LoopOptions, "profile"))
def library(
    sources: Sources,
    output: Directory,
    jobs: Jobs = None,
    clip_seconds: Seconds = 3600.0,
    clip_memory: Memory = None,
    again: Again = False,
    scheduler: Scheduler = None,
    cluster: Workers = None,
    json: Json = False,
    *,
    written: LoopOptions,
) -> None:
    """Cut, label and loop all captures below folders; group alike cycles; make them searchable.

    Writes library.json (one record a clip), cycles.csv, the loops below loops/, and what search
    needs. A file that cannot be used costs one line and is told of in the record. Interrupted,
    the command keeps what is done; run again, it does only what is new or changed. With one job
    all is done in one process, unless a limit is given. --scheduler and --cluster do the clips on
    the workers of a Dask cluster, which see sources and library by the same paths.

    Exit code 0: loops were written; 2: bad input; 3: no periodic motion was found; 130:
    interrupted.
    """
    from roundelay.library import build_library

    with one_line_errors():
        if None not in (scheduler, cluster):
            raise ValueError("expected --scheduler or --cluster, found both")
        started = time.monotonic()
        try:
            with _bar(quiet=json) as progress:
                made = build_library(
                    sources,
                    output,
                    written,
                    jobs=jobs,
                    limits=_limits(clip_seconds, clip_memory),
                    again=again,
                    cluster=scheduler or cluster,
                    progress=progress,
                    refused=lambda line: echo(f"roundelay: {line}", err=True),
                )
        except KeyboardInterrupt:
            fail("interrupted; run it again to go on", INTERRUPTED)
        if json:
            print_json(made.record)
        else:
            _print_summary(made, output, time.monotonic() - started)
    raise typer.Exit(_code(made))


def _limits(seconds: float, megabytes: int | None) -> Limits | None:
    """Return the limits of a clip; none if they are those that hold where there are processes."""
    from roundelay.library.workers import Limits

    limits = Limits(seconds, None if megabytes is None else megabytes * 1_000_000)
    return None if limits == Limits() else limits


@contextmanager
def _bar(quiet: bool) -> Iterator[Progress | None]:
    """Show a bar with the time left on standard error, if that is a terminal."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=1.0)
        yield lambda fraction, stage: bar.update(task, completed=fraction, description=stage)


def _print_summary(made: Library, folder: Path, seconds: float) -> None:
    counts = made.summary
    echo(
        f"{folder}: clips: {counts['clips']}, loops: {counts['loops']}, "
        f"groups: {counts['groups']}, refused: {counts['refused']}; {seconds:.1f} s"
    )
    passed = made.record.get("passed_over", {})
    if passed:
        told = ", ".join(f"{count} {kind}" for kind, count in passed.items())
        echo(f"  passed over, no captures: {told}")
    largest = sorted(made.record["groups"], key=lambda group: -group["behaviours"])[:10]
    for group in largest:
        echo(
            f"  group {group['group']:3d}: {shown(group['name'] or '-')}; behaviours: "
            f"{group['behaviours']}, clips: {group['clips']}; "
            f"for example {shown(group['example'] or group['example_clip'])}"
        )
    if len(made.record["groups"]) > len(largest):
        echo(f"  and {len(made.record['groups']) - len(largest)} more")


def _code(made: Library) -> int:
    if made.summary["loops"]:
        return 0
    return BAD_INPUT if made.summary["refused"] >= made.summary["clips"] else NO_PERIOD
