"""Error matrices between behaviours: figures 5 and 6 of [B]."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.segmentation.pca import intrinsic_dimension
from roundelay.segmentation.ppca import PPCAModel

__all__ = ["mahalanobis_matrix", "projection_error_matrix"]

Array = NDArray[np.float64]


def projection_error_matrix(behaviours: Sequence[ArrayLike], *, energy: float = 0.9) -> Array:
    """Return the error of joining each behaviour with each other one ([B] figure 5).

    Parameters
    ----------
    behaviours : sequence of m (n_i, d) array_like
        Poses, for instance from `joint_quaternions`; [B] takes 240 frames of each.
    energy : float
        Share of the variance that sets the dimension r of the row's behaviour (tau).

    Returns
    -------
    (m, m) ndarray
        Total error (eq. 5) of the frames of row and column together in r dimensions.
    """
    clouds = [np.asarray(behaviour, float) for behaviour in behaviours]
    ranks = [intrinsic_dimension(_squares(cloud), energy) for cloud in clouds]
    rows = [
        [_squares(np.vstack([one, other]))[rank:].sum() for other in clouds]
        for one, rank in zip(clouds, ranks, strict=True)
    ]
    return np.array(rows)


def mahalanobis_matrix(behaviours: Sequence[ArrayLike], *, energy: float = 0.95) -> Array:
    """Return the distance between each two behaviours' Gaussians ([B] figure 6).

    Parameters
    ----------
    behaviours : sequence of m (n_i, d) array_like
        Poses.
    energy : float
        Share of the variance inside the hyperplane of probabilistic PCA (tau).

    Returns
    -------
    (m, m) ndarray
        Symmetric: the larger of the two root mean squared Mahalanobis distances (eq. 10).
    """
    sums = [_sums(np.asarray(behaviour, float)) for behaviour in behaviours]
    models = [PPCAModel.of(*part, energy) for part in sums]
    distances = np.array([[model.distance(*part) for part in sums] for model in models])
    return np.maximum(distances, distances.T)


def _squares(cloud: Array) -> Array:
    return np.linalg.svd(cloud - cloud.mean(axis=0), compute_uv=False) ** 2


def _sums(cloud: Array) -> tuple[int, Array, Array]:
    return len(cloud), cloud.sum(axis=0), cloud.T @ cloud
