"""What formats of points share: their files are read as motions, too, and written from them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path

from roundelay.base.errors import FormatError, TooShort
from roundelay.formats.contents import Contents
from roundelay.formats.options import ReadOptions
from roundelay.motion.floating import motion_of_points, points_of_motion
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points

__all__ = ["ChoosesPoints", "ReadsPoints", "WritesPoints", "motion_in_file"]


def motion_in_file(
    points: Points, path: Path, *, fill: bool = True, max_gap: float | None = None
) -> Motion:
    """Make a motion of the points of a file; see `roundelay.motion.floating.motion_of_points`.

    Raises
    ------
    FormatError
        If there is no frame in which enough points are seen.
    ValueError
        If the longest gap is negative.
    """
    try:
        return motion_of_points(points, fill=fill, max_gap=max_gap)
    except TooShort as error:
        raise FormatError(str(error), path=path) from None


class ReadsPoints(ABC):
    """Read files of points, as they are or as a motion."""

    @abstractmethod
    def read_points(self, path: Path) -> Points:
        """Read the points of a file.

        Raises
        ------
        FormatError
            If the file is not what its format says.
        OSError
            If it cannot be read.
        """

    def read(self, path: Path) -> Motion:
        """Read a file as a motion whose skeleton is free.

        Raises
        ------
        FormatError
            If the file is not what its format says, or shows too little.
        OSError
            If it cannot be read.
        """
        return motion_in_file(self.read_points(path), path)


class ChoosesPoints(ReadsPoints):
    """Read files of points that may hold several bodies, or be cut off."""

    choices = frozenset({"character"})

    @abstractmethod
    def read_points(self, path: Path, wanted: ReadOptions | None = None) -> Points:
        """Read the points of a file, those of the body that is wanted."""

    @abstractmethod
    def contents(self, path: Path) -> Contents:
        """List the bodies of a file, and what it says of itself."""

    def read(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read a file as a motion whose skeleton is free; see `ReadsPoints.read`."""
        return motion_in_file(self.read_points(path, wanted), path)


class WritesPoints(ABC):
    """Write points, or the joints of any motion as points."""

    @abstractmethod
    def write_points(self, points: Points, path: Path) -> None:
        """Write points to a file, whole or not at all.

        Raises
        ------
        OSError
            If the file cannot be written.
        """

    def write(self, motion: Motion, path: Path) -> None:
        """Write the joints of a motion; of a motion of points, the points.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        self.write_points(points_of_motion(motion), path)
