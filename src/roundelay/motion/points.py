"""Points: what markers and keypoints are, with gaps and without a skeleton."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import as_number, as_numbers, as_sequence
from roundelay.base.errors import SkeletonMismatch
from roundelay.motion.poses import Mask

__all__ = ["METRES", "Points"]

Array = NDArray[np.float64]

METRES = {"m": 1.0, "cm": 1 / 100, "mm": 1 / 1000, "in": 254 / 10_000, "ft": 3048 / 10_000}
"""Metres that a unit has, by its usual sign."""


@dataclass(frozen=True, eq=False)
class Points:
    """Hold points at a constant frame rate: markers of a laboratory, keypoints of a video.

    Parameters
    ----------
    names : tuple of str
        One name a point, all different.
    positions : (F, J, 2) or (F, J, 3) array_like
        In the world, in `units`. NaN says that a point is missing.
    fps : float
        Frames a second.
    missing : (F, J) array_like of bool, optional
        What was not seen; what is not finite is missing, too. The positions of what is missing
        are held as 0 and mean nothing.
    residuals : (F, J) array_like, optional
        How far a point lies off the rays of the cameras, in `units`.
    likelihoods : (F, J) array_like, optional
        How sure a detector is of a keypoint, from 0 to 1.
    units : str
        Of length, such as "mm", "m" or "px"; empty where nobody told.
    links : iterable of (int, int)
        Pairs of points to draw lines between; those of a known set, or none, by default.
    up : {0, 1, 2}, optional
        The axis that points up; found from the points by default.
    image : bool
        Whether the second coordinate grows downward, as in pictures.
    name : str
        A name for people: by default the file's.
    layout : object, optional
        What the file it was read from holds besides; used by that format's writer only.

    Raises
    ------
    ValueError
        If shapes do not fit, there is no point, names repeat, or the rate is not positive.

    Examples
    --------
    >>> points = rl.Points.from_array(np.zeros((100, 2, 3)), fps=50.0, names=["hip", "knee"])
    >>> len(points), points.names
    (100, ('hip', 'knee'))
    """

    names: tuple[str, ...]
    positions: Array = field(repr=False)
    fps: float
    missing: Mask | None = field(default=None, repr=False)
    residuals: Array | None = field(default=None, repr=False)
    likelihoods: Array | None = field(default=None, repr=False)
    units: str = ""
    links: tuple[tuple[int, int], ...] = field(default=(), repr=False)
    up: int | None = None
    image: bool = False
    name: str = ""
    layout: Any = field(default=None, repr=False)

    def __post_init__(self) -> None:
        names = tuple(str(name) for name in as_sequence(self.names, "names"))
        positions = np.array(as_numbers(self.positions, "positions (F, J, 2 or 3)"), float)
        asked = f"(F, {len(names)}, 2) or (F, {len(names)}, 3) for {len(names)} names"
        if (
            positions.ndim != 3
            or positions.shape[1] != len(names)
            or positions.shape[2] not in (2, 3)
        ):
            raise ValueError(f"expected positions of shape {asked}, found {positions.shape}")
        if not names:
            raise ValueError("expected at least one point, found none")
        if len(set(names)) != len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise ValueError(f"expected names that differ, found {twice!r} twice")
        if not (np.isfinite(as_number(self.fps, "frame rate")) and self.fps > 0.0):
            raise ValueError(f"expected a positive frame rate, found {self.fps:g}")
        missing = ~np.all(np.isfinite(positions), axis=2)
        if self.missing is not None:
            missing |= self._of_points(self.missing, "missing").astype(bool)
        positions[missing] = 0.0
        positions.flags.writeable = missing.flags.writeable = False
        set_ = object.__setattr__
        set_(self, "names", names)
        set_(self, "positions", positions)
        set_(self, "missing", missing)
        for what in ("residuals", "likelihoods"):
            given = getattr(self, what)
            if given is not None:
                set_(self, what, self._of_points(given, what).astype(float))
        set_(self, "links", tuple((int(a), int(b)) for a, b in self.links))
        if any(not (0 <= a < len(names) and 0 <= b < len(names)) for a, b in self.links):
            raise ValueError(f"expected links between points 0 to {len(names) - 1}")

    def _of_points(self, values: ArrayLike, what: str) -> NDArray[Any]:
        result, shape = np.asarray(values), np.shape(self.positions)[:2]
        if result.shape != shape:
            raise ValueError(f"expected {what} of shape {shape}, found {result.shape}")
        return result

    @classmethod
    def from_array(
        cls,
        positions: ArrayLike,
        *,
        fps: float,
        names: Iterable[str] | None = None,
        **others: Any,
    ) -> Points:
        """Make points of an array.

        Parameters
        ----------
        positions : (F, J, 2) or (F, J, 3) array_like
            NaN says that a point is missing.
        fps : float
            Frames a second.
        names : iterable of str, optional
            "point 1" and so on by default.
        **others
            As for `Points`.

        Raises
        ------
        ValueError
            As for `Points`.
        """
        values = np.asarray(as_numbers(positions, "positions (F, J, 2 or 3)"), float)
        count = values.shape[1] if values.ndim == 3 else 0
        numbered = tuple(f"point {number}" for number in range(1, count + 1))
        return cls(numbered if names is None else tuple(names), values, fps, **others)

    @classmethod
    def from_dataset(
        cls, dataset: Any, *, individual: str | None = None, fps: float | None = None
    ) -> Points:
        """Make points of a dataset of `movement` or an array of xarray.

        Parameters
        ----------
        dataset : xarray.Dataset or xarray.DataArray
            See `roundelay.motion.datasets`.
        individual : str, optional
            Whose; the one seen most by default.
        fps : float, optional
            Frames a second; those that the dataset tells by default.

        Raises
        ------
        ValueError
            If the dataset is laid out otherwise, there is no such individual, or no rate is known.
        """
        from roundelay.motion.datasets import points_of_dataset

        return points_of_dataset(dataset, individual=individual, fps=fps)

    def to_dataset(self) -> Any:
        """Return a dataset of xarray, laid out as those of `movement`.

        Raises
        ------
        ImportError
            If xarray is not installed.
        """
        from roundelay.motion.datasets import dataset_of_points

        return dataset_of_points(self)

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        told = f"{len(self)} frames at {self.fps:.4g} fps, {self.dimensions}D"
        return f"Points({self.name!r}, {told}, {len(self.names)} points)"

    def __getitem__(self, frames: slice) -> Points:
        """Return a half-open range of frames, ``points[start:stop]``."""
        if not isinstance(frames, slice) or frames.step not in (None, 1):
            raise TypeError("expected a slice of frames without step, points[start:stop]")
        return self._taken(frames, range(len(self.names)))

    @property
    def dimensions(self) -> int:
        """2 or 3."""
        return int(self.positions.shape[2])

    @property
    def seen(self) -> Mask:
        """What was seen, (F, J)."""
        return np.logical_not(np.asarray(self.missing))

    @property
    def duration(self) -> float:
        """Seconds covered: the number of frames divided by the rate."""
        return len(self) / self.fps

    def to_array(self) -> Array:
        """Return the positions (F, J, 2 or 3), NaN where a point is missing."""
        result = self.positions.copy()
        result[self.missing] = np.nan
        return result

    def select(self, names: Sequence[str]) -> Points:
        """Return some of the points, in the order given; links between others go.

        Raises
        ------
        SkeletonMismatch
            If there is no point of a name; the message lists those there are.
        """
        places = {name: place for place, name in enumerate(self.names)}
        for name in names:
            if name not in places:
                known = ", ".join(self.names)
                raise SkeletonMismatch(f"no point {name!r}; the points are {known}")
        return self._taken(slice(None), [places[name] for name in names])

    def _taken(self, frames: slice, chosen: Sequence[int]) -> Points:
        """Return a range of frames of some points."""
        new = {old: number for number, old in enumerate(chosen)}

        def part(values: NDArray[Any] | None) -> NDArray[Any] | None:
            return None if values is None else values[frames][:, chosen]

        return replace(
            self,
            names=tuple(self.names[place] for place in chosen),
            positions=self.positions[frames][:, chosen],
            missing=part(self.missing),
            residuals=part(self.residuals),
            likelihoods=part(self.likelihoods),
            links=tuple((new[a], new[b]) for a, b in self.links if a in new and b in new),
        )
