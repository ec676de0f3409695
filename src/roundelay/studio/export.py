"""Loops, their record, the work, and the importer of an engine as one zip."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory

from roundelay.base.files import fitting, name_of, written_beside
from roundelay.loops.recipe import Loop
from roundelay.motion.motion import Motion
from roundelay.output.records import capture_record, loop_record, write_json
from roundelay.studio.work import ENDING, Work

__all__ = ["write_zip"]

_LONGEST = 100
# Of every file: the same loops make the same zip.
_WHEN = (1980, 1, 1, 0, 0, 0)
# The same files as in the folder engines/.
_IMPORTERS = {
    "unity": ("unity.txt", "Editor/RoundelayImporter.cs"),
    "unreal": ("unreal.txt", "roundelay_import.py"),
}
_HINTS = {
    None: "The loops repeat frame by frame: after the last comes the first again.",
    "unity": (
        "Unzip into the folder Assets of a project. Editor/RoundelayImporter.cs reads the record "
        "beside each FBX when that is imported, and sets loop, root motion and events."
    ),
    "unreal": (
        "In the editor's Python (plug-in Python Editor Script Plugin), with this folder on its "
        "path: import roundelay_import; "
        'roundelay_import.import_loops("THIS FOLDER/{record}", "/Game/Loops")'
    ),
    "godot": (
        "Copy the files into a project. The animation's name ends in -loop, so it repeats. In "
        "Godot 3 set Animation, FPS in its import settings to {fps:g} and switch the Optimizer off."
    ),
    "blender": (
        "File, Import, Motion Capture (.bvh); tick Update Scene FPS and Update Scene Duration."
    ),
    "maya": "File, Import; cycle the curves: Graph Editor, Curves, Post Infinity, Cycle.",
    "web": "Load with GLTFLoader of three.js; an AnimationMixer repeats the clip by itself.",
}


def write_zip(work: Work, motion: Motion, loops: Sequence[Loop], archive: Path) -> list[str]:
    """Write loops as ``roundelay loop --work`` writes them, into a zip.

    Parameters
    ----------
    work : Work
    motion : Motion
        The take.
    loops : sequence of Loop
        Of the work's parts, in order.
    archive : Path
        The zip; it appears whole or not at all.

    Returns
    -------
    list of str
        The names of the files in it.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    stem = fitting(name_of(work.path), "", _LONGEST)
    with TemporaryDirectory() as folder:
        place = Path(folder)
        _write_loops(work, motion, loops, place, stem)
        (place / "README.txt").write_text(_read_me(work, stem), encoding="utf-8")
        work.write(place / f"{stem}{ENDING}")
        _add_importer(work, place)
        paths = sorted(path for path in place.rglob("*") if path.is_file())
        with written_beside(archive) as part, zipfile.ZipFile(part, "w") as packed:
            for path in paths:
                told = zipfile.ZipInfo(path.relative_to(place).as_posix(), _WHEN)
                told.compress_type = zipfile.ZIP_DEFLATED
                packed.writestr(told, path.read_bytes())
    return [path.relative_to(place).as_posix() for path in paths]


def _write_loops(work: Work, motion: Motion, loops: Sequence[Loop], place: Path, stem: str) -> None:
    """Write the loops and their record."""
    cycles = []
    for number, loop in enumerate(loops, 1):
        name = f"{stem}_loop{number if number > 1 else ''}.{loop.render.file_format}"
        cycles.append(loop_record(loop, loop.write(place / name)))
    record = capture_record(motion, work.path, work.to_dict())
    record |= {"sampling": asdict(work.render), "cycles": cycles, "picture": None}
    write_json(record, place / f"{stem}_loop.json")


def _add_importer(work: Work, place: Path) -> None:
    importer = _IMPORTERS.get(work.render.target or "")
    if importer is None:
        return
    source = files("roundelay.studio").joinpath("importers", importer[0]).read_bytes()
    path = place / importer[1]
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(source)


def _read_me(work: Work, stem: str) -> str:
    """Return what to do with the files."""
    fps = work.render.fps or 0.0
    hint = _HINTS[work.render.target].format(record=f"{stem}_loop.json", fps=fps)
    rows = [
        f"{stem}_loop{number if number > 1 else ''}: {part.name}"
        for number, part in enumerate(work.parts, 1)
    ]
    again = f"Again, without a browser: roundelay loop --work {stem}{ENDING} --no-picture -o loops"
    beside = f"(with {work.capture} beside it)."
    return "\n".join([f"Loops of {work.capture}", "", *rows, "", hint, "", f"{again} {beside}", ""])
