"""Landmarks: a coordinate computed on few points and extended to all."""

from __future__ import annotations

import numpy as np

from roundelay.topology.kernel.reduction import F32, F64

__all__ = ["extend_phase"]


def extend_phase(distances: F32, phase: F64, radius: float) -> F64:
    """Extend a circular coordinate from landmarks to all points (Perea 2020).

    Parameters
    ----------
    distances : (m, n) array
        From each point to each landmark.
    phase : (n,) array
        Phase of the landmarks, in cycles.
    radius : float
        Half the scale of the coordinate: landmarks within it of one point are joined by an edge.

    Returns
    -------
    (m,) array
        Phases in cycles [0, 1).
    """
    nearest = distances.argmin(axis=1)
    share = np.maximum(np.float32(radius) - distances, np.float32(0))
    share[np.arange(len(share)), nearest] += np.float32(1e-12)
    step = phase.astype(np.float32)[None, :] - phase[nearest].astype(np.float32)[:, None]
    step -= np.round(step)
    moved = np.einsum("ij,ij->i", share, step) / share.sum(axis=1)
    return np.asarray((phase[nearest] + moved) % 1.0 % 1.0, np.float64)
