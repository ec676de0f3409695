"""What a laboratory records beside markers: analog channels and force plates."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Analog", "Plate"]


@dataclass(frozen=True, eq=False)
class Analog:
    """Analog channels, such as EMG and the forces of plates.

    Parameters
    ----------
    names : tuple of str
        One name a channel, all different.
    units : tuple of str
        Of each channel, such as "V" or "N"; empty where the file tells none.
    rate : float
        Samples a second: a whole multiple of the frame rate of the points.
    values : (S, C) array
        Samples of each channel in its unit.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    values: NDArray[np.float32] = field(repr=False)

    def __getitem__(self, name: str) -> NDArray[np.float32]:
        """Return the samples (S,) of a channel.

        Raises
        ------
        KeyError
            If there is none of that name.
        """
        if name not in self.names:
            raise KeyError(name)
        return self.values[:, self.names.index(name)]


@dataclass(frozen=True, eq=False)
class Plate:
    """A force plate.

    Parameters
    ----------
    kind : int
        1 gives forces, centre of pressure and free moment; 2 forces and moments; 3 the eight
        sensors of a Kistler plate; 4 forces and moments after multiplication by `matrix`.
    corners : (4, 3) array
        In the points' unit, from the one at +x +y of the plate's axes around by -x +y.
    origin : (3,) array
        From the middle of the plate's top to the origin of its forces, along its own axes.
    channels : tuple of int
        Its analog channels, counted from 0.
    matrix : (6, 6) or (8, 6) array, optional
        Of calibration.
    """

    kind: int
    corners: NDArray[np.float64] = field(repr=False)
    origin: NDArray[np.float64] = field(repr=False)
    channels: tuple[int, ...]
    matrix: NDArray[Any] | None = field(default=None, repr=False)
