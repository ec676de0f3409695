"""Lattice reduction: short, nearly orthogonal integer combinations (Lenstra, Lenstra, Lovasz)."""

from __future__ import annotations

import numpy as np

from roundelay.topology.kernel.reduction import F64, I64
from roundelay.topology.thresholds import LATTICE

__all__ = ["reduce_lattice"]


def reduce_lattice(gram: F64) -> I64:
    """Reduce the basis of a lattice given by its inner products.

    Parameters
    ----------
    gram : (r, r) array
        Inner products of the basis, positive definite.

    Returns
    -------
    (r, r) array of int
        Rows are the new basis in terms of the old one; determinant 1 or -1.
    """
    basis = np.eye(len(gram), dtype=np.int64)
    k = 1
    while k < len(gram):
        for j in range(k - 1, -1, -1):
            factors, _ = _orthogonalised(basis @ gram @ basis.T)
            basis[k] -= np.int64(np.rint(factors[k, j])) * basis[j]
        factors, norms = _orthogonalised(basis @ gram @ basis.T)
        if norms[k] >= (LATTICE.lovasz - factors[k, k - 1] ** 2) * norms[k - 1]:
            k += 1
        else:
            basis[[k - 1, k]] = basis[[k, k - 1]]
            k = max(k - 1, 1)
    return basis


def _orthogonalised(gram: F64) -> tuple[F64, F64]:
    """Gram-Schmidt factors (r, r) and squared norms (r,) of a basis by its inner products."""
    lower = np.linalg.cholesky(gram)
    diagonal = np.asarray(lower.diagonal(), np.float64)
    return np.asarray(lower / diagonal, np.float64), diagonal**2
