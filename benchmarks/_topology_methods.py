"""roundelay and its peers as functions from points to bars, and to a phase where one is given."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Result = dict[str, Any]

PRIME = 47
LIFE = 0.7

warnings.simplefilter("ignore")


def bars(diagram: NDArray[np.float64], keep: int = 5000) -> list[list[float]]:
    """The longest bars, longest first."""
    lives = diagram[:, 1] - diagram[:, 0]
    order = np.argsort(-lives, kind="stable")[:keep]
    return np.round(np.asarray(diagram, np.float64)[order], 9).tolist()


def roundelay(points: Points) -> Result:
    """Frames -> coordinate, scale chosen by the motion in time."""
    from roundelay.topology import persistent_cohomology
    from roundelay.topology.coordinate import circular_coordinate

    barcode = persistent_cohomology(points, longest=1)
    coordinate = circular_coordinate(barcode, runs=[(0, len(points))])
    return {"longest": [barcode.births[0], barcode.deaths[0]], "scale": coordinate.scale}


def roundelay_all_bars(points: Points) -> Result:
    """All bars, and the coordinate as [A] has it: uniform weights, .7 of the life."""
    from roundelay.topology import persistent_cohomology
    from roundelay.topology.coordinate import circular_coordinate

    barcode = persistent_cohomology(points)
    phase = circular_coordinate(barcode, weights="uniform").phase
    diagram = np.column_stack((barcode.births, barcode.deaths))
    return {"bars": bars(diagram), "phase": phase.tolist()}


def roundelay_landmarks(points: Points) -> Result:
    from roundelay.topology import choose_landmarks, persistent_cohomology
    from roundelay.topology.coordinate import circular_coordinate

    landmarks = choose_landmarks(points, count=400)
    barcode = persistent_cohomology(points[landmarks.indices], longest=1)
    circular_coordinate(barcode, runs=[(0, len(points))], landmarks=landmarks)
    return {"longest": [barcode.births[0], barcode.deaths[0]], "cover": landmarks.cover_radius}


def ripser(points: Points) -> Result:
    """ripser.py with its cocycle, and a sparse least-squares solve."""
    from ripser import ripser as run
    from scipy.spatial.distance import pdist, squareform

    matrix = squareform(pdist(points))
    found = run(matrix, maxdim=1, coeff=PRIME, do_cocycles=True, distance_matrix=True)
    diagram = found["dgms"][1]
    if not len(diagram):
        return {"bars": []}
    first = int(np.argmax(diagram[:, 1] - diagram[:, 0]))
    birth, death = diagram[first].tolist()
    cocycle = found["cocycles"][1][first]
    phase = least_squares(matrix, cocycle, birth + LIFE * (death - birth))
    return {"bars": bars(diagram), "phase": phase.tolist()}


def least_squares(matrix: Points, cocycle: NDArray[np.int64], scale: float) -> Points:
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import lsqr

    n = len(matrix)
    table = np.zeros((n, n))
    i, j, value = cocycle.T
    table[i, j] = np.where(value > PRIME // 2, value - PRIME, value)
    table -= table.T
    a, b = np.nonzero(np.triu(matrix <= scale, 1))
    rows = np.repeat(np.arange(len(a)), 2)
    ends = np.column_stack((a, b)).ravel()
    delta = coo_array((np.tile([-1.0, 1.0], len(a)), (rows, ends)), shape=(len(a), n))
    solution = lsqr(delta.tocsr(), -table[a, b], atol=1e-10, btol=1e-10)[0]
    return np.asarray(solution % 1.0, np.float64)


def gudhi(points: Points) -> Result:
    """Edge collapse, then persistence of the flag complex: bars only."""
    import gudhi as library

    tree = library.RipsComplex(points=points).create_simplex_tree(max_dimension=1)
    tree.collapse_edges()
    tree.expansion(2)
    tree.compute_persistence(homology_coeff_field=PRIME)
    return {"bars": bars(tree.persistence_intervals_in_dimension(1).reshape(-1, 2))}


def dreimac(points: Points) -> Result:
    """200 greedy landmarks: approximate, but with a coordinate."""
    from dreimac import CircularCoords

    if len(points) < 30:
        return {}
    coordinates = CircularCoords(points, min(200, len(points)), prime=PRIME)
    coordinates.get_coordinates(perc=0.7, cocycle_idx=0)
    return {}


def redzed(points: Points) -> Result:
    """Bars only, mod 2."""
    import redzed_tda

    found = redzed_tda.rips(redzed_tda.pairwise_distances(points), maxdim=1)
    return {"bars": bars(np.asarray(found[1], np.float64).reshape(-1, 2))}


def canns(points: Points) -> Result:
    """Bars only."""
    from canns_lib.ripser import ripser as run

    return {"bars": bars(np.asarray(run(points, maxdim=1, coeff=PRIME)["dgms"][1]))}


METHODS = {
    "roundelay": roundelay,
    "roundelay, all bars": roundelay_all_bars,
    "ripser.py + lsqr": ripser,
    "gudhi (bars)": gudhi,
    "DREiMac (200 landmarks)": dreimac,
    "redzed-tda (bars, mod 2)": redzed,
    "canns-lib (bars)": canns,
}
