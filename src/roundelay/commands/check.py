"""``roundelay check``: the faults of loops that are there already, and their mending."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from roundelay.base.files import STANDARD_INPUT, name_of, unpacked
from roundelay.base.texts import shown
from roundelay.commands.common import (
    BAD_INPUT,
    FAULTY,
    Json,
    echo,
    in_one_line,
    input_errors,
    one_line_errors,
    print_json,
    read_capture,
)
from roundelay.commands.options import takes
from roundelay.formats.options import ReadOptions

if TYPE_CHECKING:
    from roundelay.loops.lint import Apart, Fault

Source = Annotated[
    Path,
    typer.Argument(
        metavar="SOURCE",
        help="A loop, a {readers} file, as it is or packed (.gz); - for standard input, see --as; "
        "or a folder of loops, searched to any depth.",
        show_default=False,
    ),
]
Mend = Annotated[
    bool, typer.Option("--mend", help="Write what can be mended as NAME_mended beside each file.")
]
Overwrite = Annotated[
    bool, typer.Option("--overwrite", help="Write what is mended into the files themselves.")
]

_MENDED = "_mended"


@dataclass(frozen=True)
class _Checked:
    """A file and what is wrong with it.

    Parameters
    ----------
    path : Path
    loop : Apart or None
        None where it cannot be read.
    faults : tuple of Fault
    mended : Path or None
        The file that was written.
    error : str or None
        Why it was not read, or not written.
    """

    path: Path
    loop: Apart | None = None
    faults: tuple[Fault, ...] = ()
    mended: Path | None = None
    error: str | None = None


@takes(reading=ReadOptions)
def check(
    source: Source,
    mend: Mend = False,
    overwrite: Overwrite = False,
    json: Json = False,
    *,
    reading: ReadOptions,
) -> None:
    """Find the faults of loops: what would be seen when they are played.

    Frames too many or missing, a pop at the join, sliding feet, drift, a wrong frame rate or unit,
    a root bone that bobs; in a folder, gaits that are out of phase with the others. What is no
    loop, such as a raw capture, is told and never mended.

    Exit code 0: all are clean; 1: faults were found; 2: bad input, if only of one file.
    """
    with one_line_errors(source):
        if overwrite and not mend:
            raise ValueError("expected --overwrite with --mend, found it alone")
        checked, others = _checked_all(source, reading)
        if mend:
            checked = [_mended(one, overwrite, reading) for one in checked]
        if json:
            print_json({"loops": list(map(_record, checked)), "not_read": list(map(str, others))})
        else:
            for one in checked:
                _print(one, mend)
        _print_refused(checked, others)
    if any(one.error is not None for one in checked):
        raise typer.Exit(BAD_INPUT)
    if any(one.faults for one in checked):
        raise typer.Exit(FAULTY)


def _checked_all(source: Path, reading: ReadOptions) -> tuple[list[_Checked], list[Path]]:
    """Judge loops, gaits also by the phase that most of them share; list what is never read."""
    from roundelay.library.captures import files_not_read
    from roundelay.loops.lint import faults_of, phase_of_set

    others = files_not_read(source) if source.is_dir() else []
    read = _read_all(source, reading)
    phases = [one.loop.phase for one in read if one.loop is not None]
    shared = phase_of_set([phase for phase in phases if phase is not None])
    judged = [
        one if one.loop is None else replace(one, faults=faults_of(one.loop, shared))
        for one in read
    ]
    return judged, others


def _read_all(source: Path, reading: ReadOptions) -> list[_Checked]:
    """Read a file, or the files of a folder but those that were mended from others of it."""
    from roundelay.library.captures import find_captures

    if not source.is_dir():
        return [_read(source, reading)]
    found = find_captures([source.resolve()])
    paths = {source / name for name in found.captures}
    unread = [_Checked(Path(fault.filename), error=in_one_line(fault)) for fault in found.faults]
    return unread + [_read(path, reading) for path in sorted(paths) if not _made_of(path, paths)]


def _made_of(path: Path, paths: set[Path]) -> bool:
    """Tell whether a file was mended from one of these, by its name."""
    stem = name_of(path).removesuffix(_MENDED)
    original = path.with_name(f"{stem}{unpacked(path).suffix}")
    named = stem not in ("", name_of(path))
    return named and not paths.isdisjoint((original, original.with_name(f"{original.name}.gz")))


def _read(path: Path, reading: ReadOptions) -> _Checked:
    """Read a loop and take it apart, or tell why that cannot be."""
    from roundelay.loops.lint import taken_apart

    try:
        motion = read_capture(path, None, reading)
        return _Checked(path, taken_apart(motion, _wraps(_suffix(path, reading))))
    except input_errors() as error:
        return _Checked(path, error=in_one_line(error, path))


def _suffix(path: Path, reading: ReadOptions) -> str:
    """Return the suffix, with its dot, of the format that a file is read as."""
    return unpacked(path).suffix.lower() if reading.suffix is None else f".{reading.suffix}"


def _wraps(suffix: str) -> bool:
    from roundelay.formats import suffixes_of, wraps_at_last_key, writers

    return suffix in suffixes_of(writers) and wraps_at_last_key(suffix[1:])


def _mended(one: _Checked, overwrite: bool, reading: ReadOptions) -> _Checked:
    """Write a loop mended, if it is a loop and something of it can be mended."""
    from roundelay.formats import write
    from roundelay.loops.mend import mended

    if one.loop is None or not one.faults or not one.loop.recognised:
        return one
    before = one.loop.seen.motion
    motion = mended(before, one.loop.wraps)
    if motion is before:
        return one
    name = f"{name_of(one.path)}{_MENDED}{_suffix(one.path, reading)}"
    try:
        path = _overwritable(one.path, name) if overwrite else one.path.with_name(name)
        write(motion, path)
    except input_errors() as error:
        return replace(one, error=in_one_line(error, one.path))
    return replace(one, mended=path)


def _overwritable(path: Path, beside: str) -> Path:
    """Return a file that holds nothing but its motion.

    Raises
    ------
    ValueError
        If something would be lost, or it is packed or no file.
    """
    from roundelay.formats import besides_motion

    if path == STANDARD_INPUT or unpacked(path) != path:
        found = "one that is packed" if path != STANDARD_INPUT else "standard input"
    else:
        found = ", ".join(besides_motion(path))
    if found:
        told = f"{path}: expected a file of one motion alone to overwrite, found {found}"
        raise ValueError(f"{told}; --mend without --overwrite writes {beside} instead")
    return path


def _record(one: _Checked) -> dict[str, Any]:
    motion = None if one.loop is None else one.loop.seen.motion
    return {
        "file": str(one.path),
        "frames": None if motion is None else len(motion),
        "fps": None if motion is None else motion.fps,
        "recognised": None if one.loop is None else one.loop.recognised,
        "faults": [asdict(fault) for fault in one.faults],
        "mended": None if one.mended is None else str(one.mended),
        "error": one.error,
    }


def _print(one: _Checked, mend: bool) -> None:
    if one.loop is None:
        return
    motion, count = one.loop.seen.motion, len(one.faults)
    said = "clean" if not count else f"{count} fault{'s' if count > 1 else ''}"
    said = said if one.loop.recognised else f"not recognised as a loop, {said}"
    typer.echo(f"{shown(one.path)}: {len(motion)} frames at {motion.fps:.4g} fps, {said}")
    for fault in one.faults:
        typer.echo(
            f"  {fault.name}: {fault.says} ({fault.value:.3g} {fault.unit}, "
            f"limit {fault.limit:.3g})"
        )
    if one.mended is not None:
        typer.echo(f"    -> {shown(one.mended)}")
    elif mend and not one.loop.recognised:
        typer.echo("    no loop, left as it is")


def _print_refused(checked: Sequence[_Checked], others: Sequence[Path]) -> None:
    """Tell which files were not read or not written, a line each, on standard error."""
    for one in checked:
        if one.error is not None:
            echo(f"roundelay: {one.error}", err=True)
    for path in others:
        kind = path.suffix[1:].upper()
        echo(f"roundelay: note: {shown(path)}: not read, there is no reader of {kind}", err=True)
