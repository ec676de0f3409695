"""Degree-1 persistent cohomology: bars, cocycles, circular coordinates, landmarks, significance."""

from roundelay.topology.coordinate import CircularCoordinate, circular_coordinate
from roundelay.topology.distances import Metric, Runs, pairwise_distances
from roundelay.topology.landmarks import Landmarks, choose_landmarks
from roundelay.topology.rips import Barcode, persistent_cohomology
from roundelay.topology.significance import count_classes, p_values, turns, two_bar_ratio
from roundelay.topology.toroidal import combined_coordinates, toroidal_coordinates

__all__ = [
    "Barcode",
    "CircularCoordinate",
    "Landmarks",
    "Metric",
    "Runs",
    "choose_landmarks",
    "circular_coordinate",
    "combined_coordinates",
    "count_classes",
    "p_values",
    "pairwise_distances",
    "persistent_cohomology",
    "toroidal_coordinates",
    "turns",
    "two_bar_ratio",
]
