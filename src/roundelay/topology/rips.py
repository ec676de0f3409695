"""Persistent cohomology of Vietoris-Rips filtrations in degrees 0 and 1."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from roundelay.base.checks import as_numbers
from roundelay.base.threads import one_thread
from roundelay.topology.distances import (
    Metric,
    check_distances,
    check_metric,
    check_points,
    is_sparse,
    largest_finite,
    pairwise_distances,
)
from roundelay.topology.kernel import engine
from roundelay.topology.kernel.reduction import (
    F32,
    F64,
    I32,
    I64,
    U64,
    Reduction,
    count_shorter,
    count_up_to,
    ends,
    lengths_of,
)
from roundelay.topology.memory import check_memory

__all__ = ["Barcode", "enclosing_radius", "persistent_cohomology"]

LARGEST_PRIME = 46337


@dataclass(frozen=True)
class Barcode:
    """Bars of a Vietoris-Rips filtration, longest first, and the cocycles behind them.

    Attributes
    ----------
    births, deaths : (B,) arrays
        Scales at which each degree-1 class appears and dies, in the unit of the distances;
        a death is inf for a class alive at `max_scale`. Bars of length 0 are left out.
    components : (n_points - 1,) array
        Scales at which two components merge (degree-0 deaths), ascending; fewer where some
        never merge up to `max_scale`.
    n_points : int
        Number of points.
    prime : int
        The coefficients are the integers modulo this prime.
    max_scale : float
        Largest scale of the filtration.
    is_complete : bool
        Whether these are all bars, not only the longest.
    """

    births: F64
    deaths: F64
    components: F64
    n_points: int
    prime: int
    max_scale: float
    is_complete: bool
    _classes: I64 = field(repr=False)
    _lengths: F32 = field(repr=False)
    _reduction: Reduction = field(repr=False)
    _points: F64 | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        bars = "bar" if len(self) == 1 else "bars"
        bars = bars if self.is_complete else f"longest {bars}"
        return f"Barcode({len(self)} {bars} of {self.n_points} points, mod {self.prime})"

    def __len__(self) -> int:
        return len(self.births)

    @property
    def persistence(self) -> F64:
        """Length of each bar (B,), in the unit of the distances."""
        return self.deaths - self.births

    def up_to(self, scale: float) -> Barcode:
        """Return the bars born below a scale, ended there at the latest ([C] 5.3 item 5).

        Parameters
        ----------
        scale : float
            In the unit of the distances.

        Returns
        -------
        Barcode
            Longest first.
        """
        born = np.flatnonzero(self.births < scale)
        births, deaths = self.births[born], np.minimum(self.deaths[born], scale)
        order = np.lexsort((births, births - deaths))
        return replace(
            self,
            births=births[order],
            deaths=deaths[order],
            components=self.components[self.components < scale],
            max_scale=min(self.max_scale, scale),
            _classes=self._classes[born[order]],
        )

    def cocycle(self, k: int = 0, *, scale: float | None = None) -> tuple[I32, I32]:
        """Return a cocycle of class k, the one that lives from its birth until its death.

        Parameters
        ----------
        k : int
            Which bar, 0 being the longest.
        scale : float, optional
            Only the edges of at most this length; default: all that enter before the death.

        Returns
        -------
        edges : (m, 2) array of int32
            Pairs i < j, by length.
        values : (m,) array of int32
            The value of each edge, from i to j, in [0, prime).
        """
        keys = self._keys_below(k, scale)
        values = engine().propagate(self._reduction, len(keys), self._on_births(k), self.prime)
        return np.column_stack(ends(keys)).astype(np.int32), values

    def _keys_below(self, k: int, scale: float | None = None) -> U64:
        """Edges (m,) strictly shorter than the death of class k and at most as long as scale."""
        keys = self._reduction.keys[: count_shorter(self._reduction.keys, self.deaths[k])]
        return keys if scale is None else keys[: count_up_to(keys, scale)]

    def _on_births(self, k: int) -> I64:
        """Values mod p on the births (born,): 1 on class k, 0 on older and on living ones.

        A birth that dies before class k takes the value that the relation which kills it asks for.
        """
        reduced, first = self._reduction.reduced, int(self._classes[k])
        deaths, killer = self._reduction.deaths, self._reduction.killer
        values = np.zeros(len(deaths), np.int64)
        values[first] = 1
        dead = np.flatnonzero(deaths[first + 1 :] < deaths[first]) + first + 1
        for birth in dead:
            entries = slice(reduced.start[killer[birth]], reduced.start[killer[birth] + 1] - 1)
            total = reduced.value[entries] * values[reduced.index[entries]] % self.prime
            values[birth] = -total.sum() % self.prime
        return values


@one_thread
def persistent_cohomology(
    data: ArrayLike,
    *,
    metric: Metric = "euclidean",
    prime: int = 47,
    max_scale: float | None = None,
    longest: int | None = None,
) -> Barcode:
    """Compute all degree-1 bars of a point cloud exactly, with their cocycles.

    Reduced Vietoris-Rips filtration (Koyama, Memoli, Robins, Turner, arXiv 2307.16333): only
    edges with an empty lune give birth, only lunes of several components give relations.
    [A] 4.2 uses it through [A] reference 26. Points beyond some 4000 are better reduced to
    landmarks: memory grows with n^2, time with n^3 / 64.

    Parameters
    ----------
    data : (n, d) array_like, or distances
        Points, in any unit; with ``metric="precomputed"`` distances, as a matrix (n, n), condensed
        (n (n - 1) / 2,) as from SciPy's ``pdist``, or as a sparse matrix. Pairs that are infinitely
        far apart, or not stored in a sparse matrix, are never joined by an edge.
    metric : {"euclidean", "precomputed"}
        What `data` is.
    prime : int
        Coefficients modulo this prime, 2 to 46337.
    max_scale : float, optional
        Stop at this scale; default: the enclosing radius, where all classes have died, or the
        longest edge if each point lacks an edge to some other: what lives then never dies.
    longest : int, optional
        Stop, exactly, once this many longest bars are settled, and return only those.

    Returns
    -------
    Barcode
        Bars, longest first.

    Raises
    ------
    ValueError
        If distances are not symmetric, of zero diagonal and at least 0, all points are equal, or
        `prime` is not a prime in range.
    TooShort
        If there are fewer than 4 points.
    TooLarge
        If the estimated memory exceeds what the machine has free.
    """
    prime = _checked_prime(prime)
    if longest is not None and not (isinstance(longest, Integral) and longest >= 1):
        raise ValueError(f"expected longest as a whole number of at least 1, found {longest!r}")
    if max_scale is not None and not (isinstance(max_scale, Real) and max_scale >= 0):
        raise ValueError(f"expected a max_scale of at least 0, found {max_scale!r}")
    lengths = _lengths(data, metric)
    radius = enclosing_radius(lengths)
    last = radius if np.isfinite(radius) else largest_finite(lengths)
    limit = last if max_scale is None else float(np.float32(max_scale))
    limit = limit if radius == last else min(limit, last)
    is_cut = limit < radius
    early = 0 if longest is None or is_cut else longest
    reduction = engine().reduce(lengths, limit=min(limit, last), prime=prime, longest=early)
    points = np.asarray(data, np.float64) if metric == "euclidean" else None
    return _barcode(
        lengths, reduction, points,
        prime=prime, max_scale=limit, is_cut=is_cut, longest=longest,
    )  # fmt: skip


def enclosing_radius(lengths: F32) -> float:
    """Smallest distance within which some point has all others (upper triangle given)."""
    return float(np.maximum(lengths.max(axis=0), lengths.max(axis=1)).min())


def _lengths(data: ArrayLike, metric: Metric) -> F32:
    check_metric(metric)
    lengths = _distances(data) if metric == "precomputed" else _between(check_points(data))
    if not lengths.any():
        raise ValueError(
            f"expected different points, found {len(lengths)} equal ones: "
            "there is no shape to find a loop in"
        )
    return lengths


def _between(points: F64) -> F32:
    check_memory(len(points))
    return pairwise_distances(points)


def _distances(data: Any) -> F32:
    given = data if is_sparse(data) else as_numbers(data, "distances")
    if given.ndim == 2:
        check_memory(given.shape[0])
    return check_distances(given)


def _barcode(
    lengths: F32,
    reduction: Reduction,
    points: F64 | None,
    *,
    prime: int,
    max_scale: float,
    is_cut: bool,
    longest: int | None,
) -> Barcode:
    births = lengths_of(reduction.births).astype(np.float64)
    deaths = reduction.deaths.astype(np.float64)
    settled = np.isfinite(deaths) | is_cut
    classes = np.flatnonzero(settled & (deaths > births))
    order = np.lexsort((births[classes], births[classes] - deaths[classes]))
    classes = classes[order][:longest]
    merges = reduction.merges.astype(np.float64)
    return Barcode(
        births[classes], deaths[classes], merges, len(lengths), prime, max_scale, longest is None,
        classes, lengths, reduction, points,
    )  # fmt: skip


def _checked_prime(prime: object) -> int:
    number = int(prime) if isinstance(prime, Integral) else 0
    if not 2 <= number <= LARGEST_PRIME or any(
        number % q == 0 for q in range(2, math.isqrt(number) + 1)
    ):
        raise ValueError(f"expected a prime from 2 to {LARGEST_PRIME}, found {prime!r}")
    return number
