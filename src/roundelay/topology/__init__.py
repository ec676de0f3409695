"""Degree-1 persistent cohomology of point clouds: bars, cocycles, landmarks, significance."""

from roundelay.topology.distances import Runs, delay_distances, pairwise_distances
from roundelay.topology.rips import Barcode, persistent_cohomology

__all__ = ["Barcode", "Runs", "delay_distances", "pairwise_distances", "persistent_cohomology"]
