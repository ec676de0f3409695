"""What segmentation returns: segments, and the curve of the method that found them."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.cells import cell
from roundelay.base.version import __version__
from roundelay.motion.motion import Motion

__all__ = ["Curve", "Segment", "Segmentation"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Segment:
    """One behaviour, from its first frame to the next one's.

    Parameters
    ----------
    start, stop : int
        Half-open range of frames.
    label : int
        Equal labels are the same behaviour; numbered by first appearance, from 0.
    score : float or None
        How clear the weaker of its two cuts is, in the method's own measure over what the
        method asks of a cut (1 is just enough); None if the segment is the whole capture.
    period : float or None
        Seconds of one repetition if the segment is periodic, None if it is not.
    held : bool
        Whether nothing moves in it that matters.
    unseen : bool
        Whether the body is hidden in most of it.
    name : str
        As a person named it; empty if nobody did.
    """

    start: int
    stop: int
    label: int
    score: float | None = None
    period: float | None = None
    held: bool = False
    name: str = ""
    unseen: bool = False

    def __len__(self) -> int:
        return self.stop - self.start

    @property
    def periodic(self) -> bool:
        """Whether the segment repeats itself."""
        return self.period is not None

    @property
    def kind(self) -> Literal["cyclic", "unseen", "held", "passing"]:
        """Whether it repeats itself, is hidden, stands still, or none of these."""
        if self.periodic:
            return "cyclic"
        if self.unseen:
            return "unseen"
        return "held" if self.held else "passing"

    @property
    def title(self) -> str:
        """Its name, or the letter of its label: A for 0; its number from 26 on."""
        return self.name or (chr(ord("A") + self.label) if self.label < 26 else str(self.label))


@dataclass(frozen=True, eq=False)
class Curve:
    """The quantity a method watches, over time.

    Parameters
    ----------
    frames : (m,) ndarray
        Frames at which it is known, not decreasing.
    values : (m,) ndarray
    meaning : str
        What it is, for the picture's axis.
    """

    frames: Array
    values: Array
    meaning: str

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class Segmentation:
    """The segments of a capture, without gaps.

    Parameters
    ----------
    segments : tuple of Segment
        From frame 0 to the last.
    method : str
        The method's name.
    options : object
        The method's options, all given.
    frame_time : float
        Seconds from one frame to the next.
    curve : Curve
        What the method watched.
    source : str
        The capture's name.

    Examples
    --------
    >>> take = rl.concatenate([rl.read("walk.bvh"), rl.read("run.bvh")])
    >>> found = rl.segment(take)
    >>> [(segment.kind, round(segment.period, 2)) for segment in found.segments]
    [('cyclic', 1.1), ('cyclic', 0.75)]
    """

    segments: tuple[Segment, ...]
    method: str
    options: Any
    frame_time: float
    curve: Curve = field(repr=False)
    source: str = ""

    def __len__(self) -> int:
        return len(self.segments)

    @property
    def n_frames(self) -> int:
        """Number of frames of the capture."""
        return self.segments[-1].stop

    @property
    def cuts(self) -> tuple[int, ...]:
        """First frame of every segment but the first."""
        return tuple(segment.start for segment in self.segments[1:])

    @property
    def labels(self) -> NDArray[np.intp]:
        """The label (F,) of every frame."""
        return np.repeat([s.label for s in self.segments], [len(s) for s in self.segments])

    def checked(self, n_frames: int) -> Segmentation:
        """Return itself for a capture of so many frames.

        Raises
        ------
        ValueError
            If it has another number.
        """
        if n_frames != self.n_frames:
            raise ValueError(f"expected a motion of {self.n_frames} frames, found {n_frames}")
        return self

    def clips(self, motion: Motion) -> list[Motion]:
        """Return the part of a motion that belongs to each segment.

        Raises
        ------
        ValueError
            If the motion has another number of frames.
        """
        self.checked(len(motion))
        return [motion[segment.start : segment.stop] for segment in self.segments]

    def bouts(self) -> list[dict[str, Any]]:
        """Return one row a segment: start, end (seconds), seconds, label, name, kind and more."""
        return [
            {
                "start": segment.start * self.frame_time,
                "end": segment.stop * self.frame_time,
                "seconds": len(segment) * self.frame_time,
                "label": segment.label,
                "name": segment.title,
                "kind": segment.kind,
                "score": segment.score,
                "period": segment.period,
                "start_frame": segment.start,
                "end_frame": segment.stop,
            }
            for segment in self.segments
        ]

    def to_csv(self) -> str:
        """Return the bout table as CSV with a heading; times in seconds, frames half-open."""
        text, rows = io.StringIO(), self.bouts()
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: _brief(value) for key, value in row.items()} for row in rows)
        return text.getvalue()

    def to_dict(self) -> dict[str, Any]:
        """Return everything, with the version and the options used, for JSON."""
        return {
            "roundelay": __version__,
            "source": self.source,
            "method": self.method,
            "options": asdict(self.options),
            "frame_time": self.frame_time,
            "n_frames": self.n_frames,
            "segments": self.bouts(),
            "curve": {
                "meaning": self.curve.meaning,
                "frames": self.curve.frames.astype(int).tolist(),
                "values": [float(f"{value:.6g}") for value in self.curve.values],
            },
        }

    def to_json(self) -> str:
        """Return `to_dict` as JSON."""
        return json.dumps(self.to_dict(), indent=2)


def _brief(value: Any) -> Any:
    if isinstance(value, str):
        return cell(value)
    return f"{value:.6g}" if isinstance(value, float) else value
