"""What a user of [A] and of [C] sets; the defaults are those of the papers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from roundelay.base.options import Checked, option

__all__ = ["ExtractionOptions", "TrajectoryOptions"]


@dataclass(frozen=True)
class TrajectoryOptions(Checked):
    """What a user of [A] sets; the defaults are those of its section 6.1.

    Parameters
    ----------
    scale : float
        Largest scale of the Rips complex, in the unit of the values.
    dimensions : int, optional
        Principal axes to project on; none by default.
    metric : {"euclidean", "adjacent"}
        Distances of poses, or the same with frames next to each other at distance 0 ([A] 3.2).
    prime : int
        Coefficients of the cohomology.
    samples, neighbours : int
        Of the typical trajectory.
    gaussian : bool
        Weigh neighbours by a Gaussian of their distance in phase.
    """

    title: ClassVar[str] = "The pipeline of [A]"

    scale: float = option(
        50.0, "Largest scale of the Rips complex.", unit="degrees", above=0, flag="rips-scale"
    )
    dimensions: int | None = option(
        None, "Principal axes to project on.", least=1, flag="principal-axes"
    )
    metric: Literal["euclidean", "adjacent"] = option(
        "euclidean",
        "Distances of poses, or the same with frames next to each other at distance 0.",
        flag="pose-distance",
    )
    prime: int = option(47, "Coefficients are integers modulo this.", least=2, flag="modulo")
    samples: int = option(500, "Phases at which there is a centroid.", least=8)
    neighbours: int = option(10, "Poses of a centroid.", least=1, flag="nearest")
    gaussian: bool = option(
        False, "Weigh the poses of a centroid by a Gaussian.", flag="gaussian-weights"
    )


@dataclass(frozen=True)
class ExtractionOptions(Checked):
    """What a user of [C] sets besides the model; the defaults are those of its tables.

    Parameters
    ----------
    delay : int
        Embedding factor m of eq. 3.26.
    scale : float
        Maximum of the filtration's scale: 2 for walks, 3 for runs, 5 for boxing.
    prime : int
        Coefficients of the cohomology.
    remap : {"rank", "mixture"}
        From structure to time by eq. 3.20 or 3.21.
    complete : bool
        Prune the frames to complete periods of the coordinate, as chapter 7 advises.
    """

    title: ClassVar[str] = "The extraction of [C]"

    delay: int = option(2, "Following frames of the delay embedding.", least=0, flag="embedding")
    scale: float = option(
        2.0, "Largest scale of the filtration.", unit="radians", above=0, flag="epsilon"
    )
    prime: int = option(47, "Coefficients of the cohomology, modulo this prime.", least=2)
    remap: Literal["rank", "mixture"] = option(
        "rank", "From structure to time by the ranks of phases, or by their mixture."
    )
    complete: bool = option(False, "Prune the frames to complete periods.")
