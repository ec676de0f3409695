"""Points from and to datasets of xarray, as the library `movement` lays them out.

A dataset has ``position`` with the dimensions time, space, keypoints and individuals (in any
order; a single individual needs none), ``confidence`` without space, and ``fps`` among its
attributes. xarray is imported only to make one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.motion.points import Points

__all__ = ["dataset_of_points", "points_of_dataset"]

Array = NDArray[np.float64]

_AXES = ("time", "keypoints", "space")


def points_of_dataset(
    dataset: Any, *, individual: str | None = None, fps: float | None = None
) -> Points:
    """Return the points of a dataset.

    Parameters
    ----------
    dataset : xarray.Dataset or xarray.DataArray
        As `movement` makes them; an array is taken for the positions.
    individual : str, optional
        Whose; the one seen most by default.
    fps : float, optional
        Frames a second; those of the attributes, or of the times in seconds, by default.

    Returns
    -------
    Points

    Raises
    ------
    ValueError
        If the dataset is laid out otherwise, there is no such individual, or no rate is known.
    """
    positions = _positions(dataset)
    people = [str(name) for name in _labels(positions, "individuals")]
    axes = ("individuals", *_AXES) if "individuals" in positions.dims else _AXES
    _check(positions, axes)
    values = np.asarray(positions.transpose(*axes).values, float)
    values = values if "individuals" in positions.dims else values[None]
    chosen = _chosen(values, people, individual)
    flat = values.shape[3] == 2
    return Points(
        tuple(str(name) for name in _labels(positions, "keypoints")),
        values[chosen],
        _rate(dataset, positions, fps),
        likelihoods=_confidence(dataset, positions, chosen),
        units="px" if flat else "",
        image=flat,
        name=people[chosen] if people else "",
    )


def dataset_of_points(points: Points) -> Any:
    """Return points as a dataset of xarray, NaN where a point is missing.

    Raises
    ------
    ImportError
        If xarray is not installed.
    """
    import xarray

    space = list("xyz"[: points.dimensions])
    people, names = [points.name or "individual"], list(points.names)
    coords = {
        "time": np.arange(len(points)) / points.fps,
        "space": space,
        "keypoints": names,
        "individuals": people,
    }
    # movement's order of dimensions.
    position = np.moveaxis(points.to_array(), 1, 2)[..., None]
    likely = points.likelihoods
    likely = points.seen.astype(float) if likely is None else likely
    return xarray.Dataset(
        {
            "position": (("time", "space", "keypoints", "individuals"), position),
            "confidence": (("time", "keypoints", "individuals"), likely[..., None]),
        },
        coords,
        {"fps": points.fps, "time_unit": "seconds", "ds_type": "poses", "units": points.units},
    )


def _positions(dataset: Any) -> Any:
    """Return the array of positions: the one given, or the dataset's."""
    if hasattr(dataset, "dims") and not hasattr(dataset, "data_vars"):
        return dataset
    if "position" not in getattr(dataset, "data_vars", ()):
        asked = "a dataset of xarray with a variable 'position'"
        raise ValueError(f"expected {asked}, found {type(dataset).__name__}")
    return dataset["position"]


def _check(positions: Any, axes: Sequence[str]) -> None:
    if sorted(positions.dims) != sorted(axes):
        found = ", ".join(map(str, positions.dims))
        asked = "time, space, keypoints and, if there are several, individuals"
        raise ValueError(f"expected positions with the dimensions {asked}, found {found}")


def _labels(array: Any, axis: str) -> Sequence[Any]:
    if axis not in array.dims:
        return ()
    if axis in array.coords:
        return list(np.asarray(array.coords[axis].values).tolist())
    return [f"{axis.rstrip('s')} {number}" for number in range(1, array.sizes[axis] + 1)]


def _chosen(values: Array, people: Sequence[str], individual: str | None) -> int:
    if individual is None:
        return int(np.argmax(np.isfinite(values).sum(axis=(1, 2, 3))))
    if individual not in people:
        known = ", ".join(people) or "one without a name"
        raise ValueError(f"expected an individual among {known}, found {individual!r}")
    return people.index(individual)


def _rate(dataset: Any, positions: Any, fps: float | None) -> float:
    known = fps if fps is not None else getattr(dataset, "attrs", {}).get("fps")
    if known is not None:
        return float(known)
    times = np.asarray(positions.coords["time"].values if "time" in positions.coords else [])
    if len(times) > 1 and times.dtype.kind == "f":
        return float(1.0 / np.median(np.diff(times)))
    raise ValueError("expected the frames a second among the attributes, found none; give fps")


def _confidence(dataset: Any, positions: Any, chosen: int) -> Array | None:
    if "confidence" not in getattr(dataset, "data_vars", ()):
        return None
    own = dataset["confidence"]
    axes = [axis for axis in ("individuals", "time", "keypoints") if axis in own.dims]
    values = np.asarray(own.transpose(*axes).values, float)
    values = values[chosen] if "individuals" in own.dims else values
    return values if np.isfinite(values).any() else None
