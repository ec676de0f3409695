"""What a reader must do."""

from __future__ import annotations

import shutil
import warnings
from collections.abc import Iterable, Iterator
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from roundelay.base.errors import FormatError, RoundelayWarning
from roundelay.formats import Reader, SkeletonReader
from roundelay.motion.motion import Motion
from roundelay.testing.expecting import SECONDS, Subject, check_suffixes, same_motion

__all__ = ["check_reader"]

# Places at which a file is cut, and times that bytes of it are exchanged.
_CUTS, _EXCHANGES = 16, 40


def check_reader(reader: Reader, samples: Iterable[str | PathLike[str]]) -> None:
    """Check that a reader reads good files alike every time, and refuses bad ones.

    - It has a name, and suffixes in small letters; it reads files with suffixes in capitals.
    - A sample gives a `Motion` of at least one frame, the same each time, and is left as it is.
    - A file that is not there is an OSError.
    - An empty file, one of noise and one of other text are a `FormatError`.
    - A file cut short, or with wrong bytes, is a `FormatError`, unless it is a good file still.
    - Nothing takes longer than 30 s. Where the skeleton is another file, that is broken, too.

    Parameters
    ----------
    reader : Reader
    samples : iterable of path-like
        Good files of the format, at least one; small ones, for each is read some hundred times.

    Raises
    ------
    AssertionError
        If it does not.
    """
    subject = Subject("reader", reader)
    subject.expect_parts("read")
    check_suffixes(subject)
    paths = [Path(sample) for sample in samples]
    subject.expect(bool(paths), "at least one sample", "none")
    for path in paths:
        _check_sample(subject, path)


def _check_sample(subject: Subject, sample: Path) -> None:
    reader: Reader = subject.item
    known = sample.suffix.lower() in reader.suffixes
    subject.expect(known, f"a sample with a suffix among {reader.suffixes}", sample.name)
    with TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", RoundelayWarning)
        files = _copied(reader, sample, Path(folder))
        _check_good(subject, files[0])
        for file in files:
            _check_broken(subject, files[0], file)


def _copied(reader: Reader, sample: Path, folder: Path) -> list[Path]:
    """Copy a sample and the file of its skeleton."""
    skeleton = [reader.find_skeleton(sample)] if isinstance(reader, SkeletonReader) else []
    return [Path(shutil.copy(file, folder)) for file in (sample, *skeleton)]


def _check_good(subject: Subject, path: Path) -> None:
    before = path.read_bytes()
    motion = _read(subject, path, "a sample")
    subject.expect(isinstance(motion, Motion), "a Motion", type(motion).__name__)
    subject.expect(len(motion) > 0, "at least one frame", "none")
    again = _read(subject, path, "a sample")
    subject.expect(same_motion(motion, again), "the same motion again", "another")
    loud = path.with_suffix(path.suffix.upper())
    if not loud.exists():
        shutil.copy(path, loud)
    again = _read(subject, loud, "a file with its suffix in capitals")
    subject.expect(same_motion(motion, again), "the same motion of suffixes in capitals", "another")
    subject.expect(path.read_bytes() == before, "a sample left as it is", "a changed one")
    try:
        _read(subject, path.with_stem("missing"), "a missing file")
    except OSError:
        return
    except Exception as error:
        subject.expect(False, "an OSError for a missing file", repr(error))
    subject.expect(False, "an OSError for a missing file", "none")


def _check_broken(subject: Subject, path: Path, file: Path) -> None:
    """Break one of the files of a sample, and read the sample."""
    whole = file.read_bytes()
    for what, content, hopeless in _breakages(whole):
        file.write_bytes(content)
        try:
            motion = _read(subject, path, what)
        except FormatError:
            continue
        except Exception as error:
            subject.expect(False, f"a FormatError for {what} ({file.suffix})", repr(error))
        subject.expect(not hopeless, f"a FormatError for {what} ({file.suffix})", "a motion")
        subject.expect(len(motion) > 0, f"frames or a FormatError for {what}", "no frame")
    file.write_bytes(whole)


def _breakages(whole: bytes) -> Iterator[tuple[str, bytes, bool]]:
    """Yield broken files: what is wrong, the bytes, and whether no motion can come of them."""
    rng = np.random.default_rng(0)
    yield "an empty file", b"", True
    yield "a file of noise", rng.bytes(4096), True
    yield "a file of other text", b"the quick brown fox jumps over the lazy dog\n" * 20, True
    for stop in np.linspace(1, len(whole) - 1, _CUTS).astype(int).tolist():
        yield f"a file cut after {stop} of {len(whole)} bytes", whole[:stop], False
    for number in range(_EXCHANGES):
        content = np.frombuffer(whole, np.uint8).copy()
        places = rng.integers(len(content), size=3)
        # Bytes of the file itself, which go further than noise, then any.
        content[places] = rng.choice(content, 3) if number % 2 else rng.integers(256, size=3)
        yield f"a file with wrong bytes at {places.tolist()}", content.tobytes(), False


def _read(subject: Subject, path: Path, what: str) -> Motion:
    return subject.within(SECONDS, lambda: subject.item.read(path), f"reading {what}")
