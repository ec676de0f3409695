"""Cutting captures into distinct behaviours: all methods of [B], and a better default.

[B] is J. Barbic, A. Safonova, J.-Y. Pan, C. Faloutsos, J. K. Hodgins, N. S. Pollard,
"Segmenting Motion Capture Data into Distinct Behaviors", Graphics Interface 2004.
"""

from roundelay.segmentation.behaviours import BehaviourOptions
from roundelay.segmentation.cutting import method_names, segment, segment_channels, segmented
from roundelay.segmentation.features import (
    STANDARD_JOINTS,
    corresponding_joints,
    joint_quaternions,
)
from roundelay.segmentation.gaussian import GaussianOptions
from roundelay.segmentation.gmm import GMMOptions
from roundelay.segmentation.method import Channels, Cuts, SegmentationMethod
from roundelay.segmentation.methods import segmentation_methods
from roundelay.segmentation.pca import OnlinePCA, PCAOptions
from roundelay.segmentation.ppca import OnlinePPCA, PPCAOptions
from roundelay.segmentation.result import Curve, Segment, Segmentation
from roundelay.segmentation.scoring import TOLERANCES, Agreement, Score, Truth, pooled, score

__all__ = [
    "STANDARD_JOINTS",
    "TOLERANCES",
    "Agreement",
    "BehaviourOptions",
    "Channels",
    "Curve",
    "Cuts",
    "GMMOptions",
    "GaussianOptions",
    "OnlinePCA",
    "OnlinePPCA",
    "PCAOptions",
    "PPCAOptions",
    "Score",
    "Segment",
    "Segmentation",
    "SegmentationMethod",
    "Truth",
    "corresponding_joints",
    "joint_quaternions",
    "method_names",
    "pooled",
    "score",
    "segment",
    "segment_channels",
    "segmentation_methods",
    "segmented",
]
