"""What a writer must do."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from roundelay import synth
from roundelay.formats import Reader, Writer
from roundelay.motion.motion import Motion
from roundelay.testing.expecting import SECONDS, Subject, check_suffixes

__all__ = ["check_writer"]

# Body sizes by which a joint may be elsewhere after writing and reading.
_CLOSE = 1e-4
_OLD = b"what was there before"


def check_writer(writer: Writer, reader: Reader | None = None) -> None:
    """Check that a writer writes whole files, alike every time, that a reader reads.

    - It has a name, and suffixes in small letters; it writes files with suffixes in capitals.
    - It writes motions of one frame and of many, at any rate, with bones that change length.
    - The same motion gives the same bytes; all files it makes bear the name it was given.
    - A file that was there is replaced, not written into: see
      `roundelay.base.files.written_beside`.
    - Where the file cannot be written it raises an OSError and leaves nothing behind.
    - What the reader reads has the same frames, rate, and places of joints.

    Parameters
    ----------
    writer : Writer
    reader : Reader, optional
        Of the same format; without one nothing is read back.

    Raises
    ------
    AssertionError
        If it does not.
    """
    subject = Subject("writer", writer)
    subject.expect_parts("write")
    check_suffixes(subject)
    walk = synth.gait("walk", repetitions=1.2, turning=0.4, fps=30.0).motion
    jacks = synth.gait("jacks", repetitions=1.0, fps=120.0).motion
    for suffix in (*writer.suffixes, writer.suffixes[0].upper()):
        for motion in (walk, walk[:1], jacks):
            _in_folder(_check_written, subject, motion, suffix, reader)
        _in_folder(_check_written, subject, _stretched(walk), suffix, None)
        _in_folder(_check_replaced, subject, walk, suffix)
        _in_folder(_check_refused, subject, walk, suffix)


def _in_folder(check: Callable[..., None], *arguments: object) -> None:
    with TemporaryDirectory() as folder:
        check(Path(folder), *arguments)


def _stretched(motion: Motion) -> Motion:
    """Return a motion whose bones grow by a tenth."""
    scale = np.linspace(1.0, 1.1, len(motion))[:, None, None]
    return replace(motion, translations=motion.skeleton.offsets * scale)


def _check_written(
    folder: Path, subject: Subject, motion: Motion, suffix: str, reader: Reader | None
) -> None:
    path = _written(subject, motion, folder / "first", suffix)
    again = _written(subject, motion, folder / "second", suffix)
    subject.expect(path.stat().st_size > 0, f"something in {path.name}", "an empty file")
    same = _contents(path.parent) == _contents(again.parent)
    subject.expect(same, "the same bytes of the same motion", "others")
    for name in _contents(path.parent):
        subject.expect(Path(name).stem == path.stem, f"files named {path.stem}", name)
    if reader is not None:
        read = subject.within(SECONDS, lambda: reader.read(path), "reading what was written")
        _check_like(subject, motion, read)


def _check_like(subject: Subject, motion: Motion, read: Motion) -> None:
    subject.expect(len(read) == len(motion), f"{len(motion)} frames read again", len(read))
    rate = np.isclose(read.fps, motion.fps, rtol=1e-4)
    subject.expect(bool(rate), f"{motion.fps:g} frames a second read again", f"{read.fps:g}")
    (root, *names), others = motion.skeleton.names, read.skeleton.names
    lost = [name for name in names if name not in others]
    subject.expect(not lost, "all joints read again", f"all but {lost}")
    # Formats may name the root as they must, and add ends of limbs; in those of points it is a
    # point like the others.
    order = [others.index(root) if root in others else 0, *(others.index(name) for name in names)]
    apart = np.linalg.norm(read.positions()[:, order] - motion.positions(), axis=-1)
    away = float(apart.max()) / motion.skeleton.size
    subject.expect(away < _CLOSE, f"joints within {_CLOSE:g} body sizes", f"{away:.2g} apart")


def _check_replaced(folder: Path, subject: Subject, motion: Motion, suffix: str) -> None:
    path, kept = folder / f"loop{suffix}", folder / "kept"
    path.write_bytes(_OLD)
    # Not all file systems have links.
    with suppress(OSError, NotImplementedError):
        os.link(path, kept)
    _written(subject, motion, folder, suffix)
    subject.expect(path.read_bytes() != _OLD, "a new file", "the old one")
    into = kept.exists() and kept.read_bytes() != _OLD
    subject.expect(not into, "a file that is replaced when whole", "one that is written into")


def _check_refused(folder: Path, subject: Subject, motion: Motion, suffix: str) -> None:
    taken, missing = folder / f"loop{suffix}", folder / "missing" / f"loop{suffix}"
    taken.mkdir()
    for path, what in ((taken, "a folder in its place"), (missing, "a missing folder")):
        try:
            subject.item.write(motion, path)
        except OSError:
            pass
        except Exception as error:
            subject.expect(False, f"an OSError for {what}", repr(error))
        else:
            subject.expect(False, f"an OSError for {what}", "none")
    left = [one.name for one in folder.iterdir() if one.name.startswith(".")]
    subject.expect(not left, "nothing left of a file that cannot be written", left)


def _written(subject: Subject, motion: Motion, folder: Path, suffix: str) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / f"loop{suffix}"
    subject.within(SECONDS, lambda: subject.item.write(motion, path), "writing")
    subject.expect(path.is_file(), f"a file {path.name}", "none")
    return path


def _contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in sorted(folder.iterdir())}
