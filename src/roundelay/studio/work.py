"""The work: what a person decided of a take, as a file that opens again."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from roundelay.base.checks import all_expected, as_path, expected
from roundelay.base.errors import FormatError
from roundelay.base.files import content
from roundelay.base.options import Checked, option
from roundelay.cycles.events import checked_start
from roundelay.loops.options import LoopOptions
from roundelay.output.records import write_json

if TYPE_CHECKING:
    from roundelay.base.progress import Progress
    from roundelay.loops.recipe import Loop
    from roundelay.motion.motion import Motion

__all__ = ["ENDING", "Part", "Work", "checksum", "read_work"]

ENDING = ".work.json"
"""How names of work files end."""
_KIND = "roundelay work"
_VERSION = 1

Made = TypeVar("Made")


@dataclass(frozen=True)
class Part(Checked):
    """One behaviour of a take, as a person sees it.

    Parameters
    ----------
    name : str
    spans : tuple of (int, int)
        Half-open ranges of frames that show it, in order of time.
    motion : int, optional
        The motion that was found by itself and is taken as it is, 1 being the first; None where
        a person changed its frames.
    period : float, optional
        Seconds of a repetition; found by default.
    limbs : str, optional
        The limbs that repeat; found by default.
    class_index : int, optional
        The class of the barcode that is its phase.
    method : str
        How poses become a cycle; see `roundelay.Options`.
    start : float or str
        Where its loop begins; see `roundelay.LoopOptions`.

    Raises
    ------
    ValueError
        If a value is out of range.

    Examples
    --------
    >>> rl.Part("walk", ((0, 120), (200, 320)), limbs="legs").untouched
    False
    """

    name: str = option("", "What it is called.")
    spans: tuple[tuple[int, int], ...] = option((), "The frames that show it.", least=0)
    motion: int | None = option(None, "The motion found by itself.", least=1)
    period: float | None = option(None, "Seconds of a repetition.", above=0)
    limbs: str | None = option(None, "The limbs that repeat.")
    class_index: int | None = option(None, "The class that is its phase.", least=0)
    method: str = option("auto", "How poses become a cycle.")
    start: float | str = option(0.0, "Where its loop begins.", least=0, below=1)

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_start(self.start)
        if not self.spans:
            raise ValueError("expected spans as a range of frames or more, found none")
        last = 0
        for start, stop in self.spans:
            if not last <= start < stop:
                raise ValueError(f"expected spans in order of time, found {start} to {stop}")
            last = stop

    @property
    def untouched(self) -> bool:
        """Whether it is a motion as it was found, but for its name."""
        return self.motion is not None and self == Part(self.name, self.spans, self.motion)


@dataclass(frozen=True)
class Work:
    """What a person decided of a take.

    Parameters
    ----------
    capture : str
        Name of the file of the take, which lies beside that of the work.
    checksum : str
        SHA-256 of that file.
    frames : int
        Of the take.
    parts : tuple of Part
        A loop is made of each.
    render : LoopOptions
        How the loops are written.
    folder : Path
        Where the work's file lies.

    Examples
    --------
    >>> work = rl.Work("walk.bvh", "", 400, (rl.Part("walk", ((0, 400),)),))
    >>> work.to_dict()["parts"]
    [{'name': 'walk', 'spans': ((0, 400),)}]
    """

    capture: str
    checksum: str
    frames: int
    parts: tuple[Part, ...]
    render: LoopOptions = field(default_factory=LoopOptions)
    folder: Path = field(default=Path(), compare=False)

    def __post_init__(self) -> None:
        name = expected(str, self.capture)
        if Path(name).name != name or name in ("", ".."):
            raise ValueError(f"expected the name of a file beside the work, found {self.capture!r}")
        for part in all_expected(Part, self.parts):
            if part.spans[-1][1] > self.frames:
                raise ValueError(
                    f"expected parts within {self.frames} frames, found {part.name!r} up to "
                    f"{part.spans[-1][1]}"
                )

    @property
    def path(self) -> Path:
        """Where the take lies."""
        return self.folder / self.capture

    def motion(self) -> Motion:
        """Read the take.

        Raises
        ------
        FormatError
            If it is not the file that the work was made of.
        OSError
            If it cannot be read.
        """
        from roundelay.formats import read

        found = checksum(self.path)
        if found != self.checksum:
            raise FormatError(
                f"expected the take that the work was made of (SHA-256 {self.checksum[:12]}), "
                f"found another one ({found[:12]}); put the old file back, or begin anew",
                path=self.path,
            )
        return read(self.path)

    def loops(self, progress: Progress | None = None) -> list[Loop]:
        """Read the take and make its loops; see `roundelay.make_loops`.

        Parameters
        ----------
        progress : callable, optional
            Called with the fraction done and the stage's name; returning False cancels.

        Raises
        ------
        FormatError
            If the take is not the file that the work was made of.
        NoPeriod
            If a part shows nothing that repeats; the message names it.
        OSError
            If the take cannot be read.
        """
        from roundelay.studio.making import loops_of

        return loops_of(self, self.motion(), progress=progress)

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain data; what is as usual is left out."""
        usual = asdict(LoopOptions())
        return {
            _KIND: _VERSION,
            "capture": {"file": self.capture, "sha256": self.checksum, "frames": self.frames},
            "parts": [_told(part) for part in self.parts],
            "render": {k: v for k, v in asdict(self.render).items() if v != usual[k]},
        }

    @classmethod
    def of_dict(cls, data: Any, folder: Path = Path()) -> Work:
        """Make the work of plain data, as from `to_dict`.

        Raises
        ------
        ValueError
            If it is no work, or of a later version, or a value is out of range.
        """
        if not isinstance(data, dict) or data.get(_KIND) is None:
            raise ValueError(f'expected a work of the studio ("{_KIND}"), found something else')
        if data[_KIND] != _VERSION:
            raise ValueError(f"expected version {_VERSION} of a work, found {data[_KIND]!r}")
        capture, parts = _of(data, "capture", dict), _of(data, "parts", list)
        return cls(
            _of(capture, "file", str),
            _of(capture, "sha256", str),
            _of(capture, "frames", int),
            tuple(_made(Part, one, f"part {n}") for n, one in enumerate(parts, 1)),
            _made(LoopOptions, data.get("render", {}), "render"),
            folder,
        )

    def write(self, path: str | PathLike[str]) -> None:
        """Write the work; the file appears whole or not at all.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        write_json(self.to_dict(), Path(path))


def read_work(path: str | PathLike[str]) -> Work:
    """Read the work that the studio left.

    Parameters
    ----------
    path : path-like

    Raises
    ------
    FormatError
        If it is no work.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> rl.Work("walk.bvh", "", 400, (rl.Part("walk", ((0, 400),)),)).write("walk.work.json")
    >>> rl.read_work("walk.work.json").parts[0].name
    'walk'
    """
    path = as_path(path)
    try:
        return Work.of_dict(json.loads(content(path)), path.parent)
    except (ValueError, RecursionError) as error:
        told = str(error) or "brackets without end"
        raise FormatError(told if "expected" in told else f"expected JSON, found: {told}",
                          path=path) from None  # fmt: skip


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    return sha256(content(path)).hexdigest()


def _told(part: Part) -> dict[str, Any]:
    usual = {one.name: one.default for one in fields(Part)}
    return {k: v for k, v in asdict(part).items() if k == "name" or v != usual[k]}


def _of(data: dict[str, Any], key: str, kind: type[Made]) -> Made:
    found = data.get(key)
    if not isinstance(found, kind) or isinstance(found, bool):
        raise ValueError(f"expected {key!r} as {kind.__name__}, found {found!r:.60}")
    return found


def _made(kind: type[Made], values: Any, where: str) -> Made:
    """Make a dataclass of values by name."""
    if not isinstance(values, dict):
        raise ValueError(f"{where}: expected values by name, found {values!r:.60}")
    odd = sorted(set(values) - set(_names(kind)))
    if odd:
        raise ValueError(f"{where}: expected no {odd[0]!r}; known are {', '.join(_names(kind))}")
    try:
        return kind(**values)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{where}: {error}") from None


def _names(kind: Any) -> Iterator[str]:
    return (one.name for one in fields(kind))
