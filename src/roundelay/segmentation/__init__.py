"""Cutting captures into distinct behaviours: all methods of [B], and a better default.

[B] is J. Barbic, A. Safonova, J.-Y. Pan, C. Faloutsos, J. K. Hodgins, N. S. Pollard,
"Segmenting Motion Capture Data into Distinct Behaviors", Graphics Interface 2004.
"""

from roundelay.segmentation.features import (
    STANDARD_JOINTS,
    corresponding_joints,
    joint_quaternions,
)
from roundelay.segmentation.gaussian import GaussianOptions
from roundelay.segmentation.gmm import GMMOptions
from roundelay.segmentation.methods import Method, segment, segment_channels
from roundelay.segmentation.pca import OnlinePCA, PCAOptions
from roundelay.segmentation.ppca import OnlinePPCA, PPCAOptions
from roundelay.segmentation.result import Curve, Segment, Segmentation
from roundelay.segmentation.scoring import TOLERANCES, Agreement, Score, Truth, pooled, score

__all__ = [
    "STANDARD_JOINTS",
    "TOLERANCES",
    "Agreement",
    "Curve",
    "GMMOptions",
    "GaussianOptions",
    "Method",
    "OnlinePCA",
    "OnlinePPCA",
    "PCAOptions",
    "PPCAOptions",
    "Score",
    "Segment",
    "Segmentation",
    "Truth",
    "corresponding_joints",
    "joint_quaternions",
    "pooled",
    "score",
    "segment",
    "segment_channels",
]
