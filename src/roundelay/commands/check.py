"""``roundelay check``: the faults of loops that are there already, and their mending."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from roundelay.base.texts import shown
from roundelay.commands.common import FAULTY, Json, one_line_errors, print_json, read_capture
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions

if TYPE_CHECKING:
    from roundelay.loops.lint import Fault
    from roundelay.motion.motion import Motion

Source = Annotated[
    Path,
    typer.Argument(
        metavar="SOURCE",
        help="A loop, a {readers} file; or a folder of loops, searched to any depth.",
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
    """A loop and what is wrong with it."""

    path: Path
    motion: Motion
    wraps: bool
    faults: tuple[Fault, ...]


@takes(reading=only(ReadOptions, "capture_fps"))
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
    a root bone that bobs; in a folder, gaits that are out of phase with the others.

    Exit code 0: all are clean; 1: faults were found; 2: bad input.
    """
    with one_line_errors(source):
        if overwrite and not mend:
            raise ValueError("expected --overwrite with --mend, found it alone")
        checked = _checked_all(_loops(source), reading)
        written = [_mended(one, overwrite) if mend and one.faults else None for one in checked]
        if json:
            print_json({"loops": list(map(_record, checked, written))})
        else:
            for one, path in zip(checked, written, strict=True):
                _print(one, path)
    if any(one.faults for one in checked):
        raise typer.Exit(FAULTY)


def _loops(source: Path) -> list[Path]:
    """List a file, or the files of a folder but those that were mended from others of it."""
    from roundelay.library.captures import find_captures

    found, faults = find_captures([source.resolve()], Path())
    if faults:
        raise faults[0]
    if not source.is_dir():
        return [source]
    paths = {source / name for name in found}
    return sorted(path for path in paths if _original(path) not in paths)


def _original(path: Path) -> Path | None:
    """Return from which file one was mended, by its name; None if it was not."""
    stem = path.stem.removesuffix(_MENDED)
    return path.with_stem(stem) if stem not in ("", path.stem) else None


def _checked_all(paths: Sequence[Path], reading: ReadOptions) -> list[_Checked]:
    """Judge loops, gaits also by the phase that most of them share."""
    from roundelay.loops.lint import lint, phase_of_set

    loops = [(path, read_capture(path, None, reading), _wraps(path)) for path in paths]
    phases = [_phase(*loop) for loop in loops]
    shared = phase_of_set([phase for phase in phases if phase is not None])
    return [
        _Checked(path, motion, wraps, lint(motion, wraps, shared)) for path, motion, wraps in loops
    ]


def _wraps(path: Path) -> bool:
    from roundelay.formats import suffixes_of, wraps_at_last_key, writers

    suffix = path.suffix.lower()
    return suffix in suffixes_of(writers) and wraps_at_last_key(suffix[1:])


def _phase(path: Path, motion: Motion, wraps: bool) -> float | None:
    """Return the phase of a gait; refuse a file that is too short, by its name."""
    from roundelay.base.errors import FormatError, TooShort
    from roundelay.loops.lint import left_phase

    try:
        return left_phase(motion, wraps)
    except TooShort as error:
        raise FormatError(str(error), path=path) from None


def _mended(one: _Checked, overwrite: bool) -> Path | None:
    """Write a loop mended; None if nothing of it can be mended."""
    from roundelay.formats import write
    from roundelay.loops.mend import mended

    motion = mended(one.motion, one.wraps)
    if motion is one.motion:
        return None
    path = one.path if overwrite else one.path.with_stem(one.path.stem + _MENDED)
    write(motion, path)
    return path


def _record(one: _Checked, written: Path | None) -> dict[str, Any]:
    return {
        "file": str(one.path),
        "frames": len(one.motion),
        "fps": one.motion.fps,
        "faults": [asdict(fault) for fault in one.faults],
        "mended": None if written is None else str(written),
    }


def _print(one: _Checked, written: Path | None) -> None:
    count = len(one.faults)
    said = "clean" if not count else f"{count} fault{'s' if count > 1 else ''}"
    typer.echo(f"{shown(one.path)}: {len(one.motion)} frames at {one.motion.fps:.4g} fps, {said}")
    for fault in one.faults:
        typer.echo(
            f"  {fault.name}: {fault.says} ({fault.value:.3g} {fault.unit}, "
            f"limit {fault.limit:.3g})"
        )
    if written is not None:
        typer.echo(f"    -> {shown(written)}")
