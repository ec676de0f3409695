"""What commands share: arguments, progress, one-line errors, exit codes."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from errno import ENOTDIR
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

if TYPE_CHECKING:
    from roundelay.base.progress import Progress
    from roundelay.motion.motion import Motion

__all__ = [
    "BAD_INPUT",
    "FAULTY",
    "INTERRUPTED",
    "NO_PERIOD",
    "Capture",
    "Directory",
    "File",
    "Json",
    "Picture",
    "Skeleton",
    "fail",
    "one_line_errors",
    "output_directory",
    "print_capture",
    "print_json",
    "progress_bar",
    "read_capture",
]

FAULTY, BAD_INPUT, NO_PERIOD, INTERRUPTED = 1, 2, 3, 130

Capture = Annotated[
    Path, typer.Argument(metavar="CAPTURE", help="A {readers} file.", show_default=False)
]
Skeleton = Annotated[
    Path | None,
    typer.Option(help="The ASF of an AMC; looked for beside it by default.", show_default=False),
]
Directory = Annotated[
    Path, typer.Option("-o", "--output", help="Folder for the results; made if need be.")
]
File = Annotated[
    Path,
    typer.Option("-o", "--file", help="File to write: {writers}.", show_default=False),
]
Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON.")]
Picture = Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the PNG.")]


def fail(message: str, code: int = BAD_INPUT) -> NoReturn:
    """End the program with one line on standard error."""
    typer.echo(f"roundelay: {message}", err=True)
    raise typer.Exit(code)


@contextmanager
def one_line_errors(capture: Path | None = None) -> Iterator[None]:
    """Turn errors of the input into one line and exit code 2, warnings into one line each.

    The work inside is done with one thread, also what draws its results.
    Errors that name no file themselves are those of `capture`, if that is given.
    """
    from roundelay.base.errors import FormatError, NoPeriod, RoundelayError
    from roundelay.base.threads import one_thread

    named = "" if capture is None else f"{capture}: "

    with one_thread, warnings.catch_warnings():
        warnings.showwarning = _show_warning
        try:
            yield
        except NoPeriod as error:
            fail(f"{named}{error}", NO_PERIOD)
        except (FormatError, ValueError) as error:
            fail(str(error))
        except RoundelayError as error:
            fail(f"{named}{error}")
        except BrokenPipeError:
            raise
        except OSError as error:
            fail(f"{error.filename or 'file'}: {error.strerror or error}")
        except MemoryError:
            fail(f"{named}out of memory")


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    typer.echo(f"roundelay: note: {message}", err=True)


def read_capture(path: Path, skeleton: Path | None) -> Motion:
    """Read a capture with the skeleton it needs."""
    from roundelay.formats import read

    return read(path, skeleton=skeleton)


def output_directory(path: Path) -> Path:
    """Make the folder for the results.

    Raises
    ------
    OSError
        If it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(ENOTDIR, "expected a folder, found a file", str(path)) from None
    return path


@contextmanager
def progress_bar(quiet: bool) -> Iterator[Progress | None]:
    """Show a bar on standard error while work is done, if that is a terminal."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=1.0)
        yield lambda fraction, stage: bar.update(task, completed=fraction, description=stage)


def print_capture(capture: dict[str, Any]) -> None:
    """Say what was read, from the record of a capture."""
    typer.echo(
        f"{capture['file']}: {capture['frames']} frames at {capture['fps']:.4g} fps, "
        f"{capture['seconds']:.1f} s, {capture['joints']} joints"
    )


def print_json(record: dict[str, Any]) -> None:
    """Print a record for machines."""
    typer.echo(json.dumps(record, indent=1))
