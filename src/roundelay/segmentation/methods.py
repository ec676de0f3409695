"""The methods of [B] and the default, by name, and those that plug-ins bring."""

from __future__ import annotations

import numpy as np

from roundelay.base.errors import TooShort
from roundelay.base.registry import Registry
from roundelay.segmentation.behaviours import Behaviours
from roundelay.segmentation.gaussian import (
    GaussianOptions,
    cut_evidence,
    evidence_curve,
    gaussian_cuts,
)
from roundelay.segmentation.gmm import GMMOptions, gmm_labels
from roundelay.segmentation.method import Channels, Cuts, SegmentationMethod
from roundelay.segmentation.pca import OnlinePCA, PCAOptions
from roundelay.segmentation.ppca import PPCAOptions, ppca_cuts
from roundelay.segmentation.result import Curve

__all__ = ["GMM", "PCA", "PPCA", "Behaviours", "Gaussian", "segmentation_methods"]


class Gaussian:
    """What the default proposes: piecewise Gaussian, by penalised likelihood."""

    name = "gaussian"
    options = GaussianOptions()

    def find(self, channels: Channels, options: GaussianOptions) -> Cuts:
        """Find the cuts; see `roundelay.segmentation.SegmentationMethod`."""
        model = channels.model(options.resolution)
        cuts = gaussian_cuts(model, options)
        strengths = cut_evidence(model, cuts) * options.sensitivity
        places, values = evidence_curve(model, cuts)
        meaning = "evidence for a cut (1 is enough)"
        curve = Curve(places * float(model.step), values * options.sensitivity, meaning)
        return Cuts([cut * model.step for cut in cuts], strengths.tolist(), curve)


class PCA:
    """Cuts where the projection error grows ([B] 3.1)."""

    name = "pca"
    options = PCAOptions()

    def find(self, channels: Channels, options: PCAOptions) -> Cuts:
        """Find the cuts; see `roundelay.segmentation.SegmentationMethod`."""
        values, start = channels.values, round(options.start * channels.fps)
        if len(values) <= start:
            raise TooShort(f"expected more than {start} frames, found {len(values)}")
        online = OnlinePCA(channels.fps, options)
        online.push(values)
        rows = np.array(online.growth, float).reshape(-1, 3)
        curve = Curve(rows[:, 0], rows[:, 1], "growth of the projection error, d_i")
        return Cuts(online.cuts, online.strengths, curve)


class PPCA:
    """Cuts where the coming frames are unlike those before ([B] 3.2)."""

    name = "ppca"
    options = PPCAOptions()

    def find(self, channels: Channels, options: PPCAOptions) -> Cuts:
        """Find the cuts; see `roundelay.segmentation.SegmentationMethod`."""
        cuts, strengths, watched = ppca_cuts(channels.values, channels.fps, options)
        rows = np.array(watched, float).reshape(-1, 2)
        curve = Curve(rows[:, 0], rows[:, 1], "Mahalanobis distance of the coming frames, H")
        return Cuts(cuts, strengths, curve)


class GMM:
    """Cuts where poses go from one cluster to another ([B] 3.3)."""

    name = "gmm"
    options = GMMOptions()

    def find(self, channels: Channels, options: GMMOptions) -> Cuts:
        """Find the cuts; see `roundelay.segmentation.SegmentationMethod`."""
        clusters, certainty = gmm_labels(channels.values, channels.fps, options, channels.rng)
        cuts = (np.flatnonzero(np.diff(clusters)) + 1).tolist()
        bounds = [0, *cuts, len(channels.values)]
        number: dict[int, int] = {}
        labels = [number.setdefault(int(clusters[start]), len(number)) for start in bounds[:-1]]
        sure = np.add.reduceat(certainty, bounds[:-1]) / np.diff(bounds)
        strengths = np.minimum(sure[1:], sure[:-1]).tolist()
        frames = np.arange(len(certainty), dtype=float)
        return Cuts(cuts, strengths, Curve(frames, certainty, "certainty of the cluster"), labels)


segmentation_methods: Registry[SegmentationMethod] = Registry(
    "segmentation method", "roundelay.segmentation_methods", SegmentationMethod
)
segmentation_methods.add(Behaviours())
segmentation_methods.add(Gaussian())
segmentation_methods.add(PCA())
segmentation_methods.add(PPCA())
segmentation_methods.add(GMM())
