"""What commands share: arguments, progress, one-line errors, exit codes."""

from __future__ import annotations

import json
import re
import sys
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from errno import ENOTDIR
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from roundelay.base.errors import in_one_line, input_errors
from roundelay.base.files import fitting
from roundelay.base.texts import printable, shown

if TYPE_CHECKING:
    from roundelay.base.progress import Progress
    from roundelay.formats.options import ReadOptions
    from roundelay.loops.options import LoopOptions
    from roundelay.motion.motion import Motion
    from roundelay.retargeting.options import OntoOptions
    from roundelay.segmentation import Segmentation

__all__ = [
    "BAD_INPUT",
    "FAULTY",
    "INTERRUPTED",
    "NO_PERIOD",
    "Capture",
    "Captures",
    "Directory",
    "Json",
    "Output",
    "Picture",
    "Place",
    "Skeleton",
    "Timetable",
    "echo",
    "exit_code",
    "fail",
    "in_format_of",
    "in_one_line",
    "input_errors",
    "one_line_errors",
    "output_directory",
    "place_of",
    "print_capture",
    "print_json",
    "progress_bar",
    "read_capture",
    "refuse_over",
    "table_of",
]

FAULTY, BAD_INPUT, NO_PERIOD, INTERRUPTED = 1, 2, 3, 130
# Bytes of a name that others begin with: with what follows, each fits.
_LONGEST = 100
_LIKE_A_SUFFIX = re.compile(r"\.[a-z]{2,5}")

Capture = Annotated[
    Path,
    typer.Argument(
        metavar="CAPTURE",
        help="A {readers} file, as it is or packed (.gz); - for standard input, see --as.",
        show_default=False,
    ),
]
Captures = Annotated[
    list[Path],
    typer.Argument(
        metavar="CAPTURE",
        help="{readers} files, as they are or packed (.gz); - for standard input, see --as.",
        show_default=False,
    ),
]
Skeleton = Annotated[
    Path | None,
    typer.Option(help="The ASF of an AMC; looked for beside it by default.", show_default=False),
]
Directory = Annotated[
    Path, typer.Option("-o", "--output", help="Folder for the results; made if need be.")
]
Output = Annotated[
    str,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE|FOLDER",
        help="A file, by its suffix; else a folder for files named after the capture. Folders are "
        "made if need be.",
    ),
]
Timetable = Annotated[
    Path | None,
    typer.Option(
        "--timeline",
        help="A table of behaviours that a person edited: start, end (seconds) and name.",
        show_default=False,
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON.")]
Picture = Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the PNG.")]


def echo(text: str, *, err: bool = False) -> None:
    """Print lines of text; what would command a terminal is shown instead."""
    typer.echo(printable(text), err=err)


def fail(message: str, code: int = BAD_INPUT) -> NoReturn:
    """End the program with one line on standard error."""
    echo(f"roundelay: {message}", err=True)
    raise typer.Exit(code)


@contextmanager
def one_line_errors(capture: Path | None = None) -> Iterator[None]:
    """Turn errors of the input into one line and exit code 2, warnings into one line each.

    The work inside is done with one thread, also what draws its results.
    Errors that name no file themselves are those of `capture`, if that is given.
    """
    from roundelay.base.errors import NoPeriod
    from roundelay.base.threads import one_thread

    with one_thread, warnings.catch_warnings():
        warnings.showwarning = _show_warning
        try:
            yield
        except BrokenPipeError:
            raise
        except input_errors() as error:
            code = NO_PERIOD if isinstance(error, NoPeriod) else BAD_INPUT
            fail(in_one_line(error, capture), code)


def exit_code(work: Callable[[], None]) -> int:
    """Do the work on one of several captures and return the exit code that it asks for."""
    try:
        work()
    except typer.Exit as end:
        return end.exit_code
    return 0


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    echo(f"roundelay: note: {message}", err=True)


def read_capture(
    path: Path, skeleton: Path | None, reading: ReadOptions, carrying: OntoOptions | None = None
) -> Motion:
    """Read a capture with the skeleton it needs, carried to a character if one is asked for."""
    from roundelay.formats import read

    motion = read(
        path,
        skeleton=skeleton,
        fps=reading.capture_fps,
        suffix=reading.suffix,
        fill_gaps=reading.fill_gaps,
        max_gap=reading.max_gap,
        animation=reading.animation,
        character=reading.character,
        salvage=reading.salvage,
        encoding=reading.encoding,
    )
    if carrying is None or carrying.onto is None:
        return motion
    from roundelay.retargeting.characters import to_character

    return to_character(motion, carrying)(motion)


@dataclass(frozen=True)
class Place:
    """Where a command writes.

    Parameters
    ----------
    folder : Path
    name : str
        Of the capture, cut if it is long: files in a folder begin with it.
    file : Path or None
        The file that was asked for by its name.
    """

    folder: Path
    name: str
    file: Path | None = None

    def path(self, kind: str, suffix: str, number: str = "") -> Path:
        """Return the path of a file of a kind; in a folder its name tells the kind, too."""
        named = f"{self.name}_{kind}" if self.file is None else self.file.stem
        return self.folder / f"{named}{number}{suffix}"


def place_of(output: str, name: str, suffixes: Iterable[str]) -> Place:
    """Tell a file to write from a folder, and make the folder: one rule for all commands.

    What ends in a suffix that the command writes is a file, unless it is a folder already.

    Parameters
    ----------
    output : str
        As it was typed.
    name : str
        Of the capture.
    suffixes : iterable of str
        That the command writes, with their dots.

    Raises
    ------
    ValueError
        If it looks like a file of another type.
    OSError
        If the folder cannot be made.
    """
    path, known, name = Path(output), tuple(suffixes), fitting(name, "", _LONGEST)
    suffix = path.suffix.lower()
    if output.endswith("/") or path.is_dir():
        return Place(output_directory(path), name)
    if suffix in known:
        return Place(output_directory(path.parent), name, path)
    if _LIKE_A_SUFFIX.fullmatch(suffix):
        told = f"expected a folder, or a file of type {', '.join(known)}, found {path.name!r}"
        raise ValueError(f"{told}; end the name of a folder with /")
    return Place(output_directory(path), name)


def refuse_over(capture: Path, place: Place) -> None:
    """Refuse to write over the capture itself.

    Raises
    ------
    ValueError
        If that is where a command would write.
    """
    if place.file is not None and place.file.resolve() == capture.resolve():
        raise ValueError(f"{place.file}: expected another file than the capture itself")


def output_directory(path: Path) -> Path:
    """Make the folder for the results.

    Raises
    ------
    OSError
        If it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        at = next((each for each in (path, *path.parents) if each.is_file()), path)
        raise NotADirectoryError(ENOTDIR, "expected a folder, found a file", str(at)) from None
    return path


def in_format_of(
    place: Place, written: LoopOptions, given: Collection[str], capture: Path, reading: ReadOptions
) -> LoopOptions:
    """Return options of the format to write.

    It is the one that the suffix of a file asks for, if a file was named; for points, if nothing
    was asked for, their own.

    Parameters
    ----------
    place : Place
    written : LoopOptions
    given : collection of str
        The flags of the options that were given.
    capture : Path
        What is read, the first of several.
    reading : ReadOptions

    Raises
    ------
    ValueError
        If another format was asked for, too, or the target does not read it.
    FormatError
        If no reader knows the capture's suffix.
    """
    if place.file is None:
        from roundelay.formats import format_of_points

        own = None if {"format", "for"} & set(given) else format_of_points(capture, reading.suffix)
        return written if own is None else written.in_format(own)
    suffix = place.file.suffix[1:].lower()
    if "format" in given and written.file_format != suffix:
        asked = f"--format {written.file_format}, found {place.file.name!r}"
        raise ValueError(f"expected a file of the suffix of {asked}; leave one of them out")
    return written.in_format(suffix)


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
    parts = f"{capture['points']} points" if "points" in capture else f"{capture['joints']} joints"
    echo(
        f"{shown(capture['file'])}: {capture['frames']} frames at {capture['fps']:.4g} fps, "
        f"{capture['seconds']:.1f} s, {parts}"
    )


def print_json(record: dict[str, Any] | list[dict[str, Any]]) -> None:
    """Print a record, or several, for machines."""
    typer.echo(json.dumps(record, indent=1))


def table_of(path: Path, motion: Motion) -> Segmentation:
    """Read cuts and names of a capture that a person edited."""
    from roundelay.segmentation import edited_segments

    return edited_segments(path, len(motion), motion.fps)
