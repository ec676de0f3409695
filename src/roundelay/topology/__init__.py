"""Degree-1 persistent cohomology of point clouds: bars, cocycles, landmarks, significance."""

from roundelay.topology.distances import Metric, Runs, pairwise_distances
from roundelay.topology.landmarks import Landmarks, choose_landmarks
from roundelay.topology.rips import Barcode, persistent_cohomology
from roundelay.topology.significance import (
    Periodicity,
    count_classes,
    p_values,
    periodicity,
    turns,
    two_bar_ratio,
)

__all__ = [
    "Barcode",
    "Landmarks",
    "Metric",
    "Periodicity",
    "Runs",
    "choose_landmarks",
    "count_classes",
    "p_values",
    "pairwise_distances",
    "periodicity",
    "persistent_cohomology",
    "turns",
    "two_bar_ratio",
]
