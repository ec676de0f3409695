"""The capture as the page plays it: joint positions at some 30 frames a second."""

from __future__ import annotations

import math
from dataclasses import astuple
from typing import Any

import numpy as np

from roundelay.motion.motion import Motion
from roundelay.output.figures.space import Space, bones
from roundelay.output.page.feet import foot_spans
from roundelay.output.page.packing import Packer

__all__ = ["capture_data", "sampling_step"]

# Captures with more samples than this are thinned below 30 a second, but not below 10.
_MOST_SAMPLES = 3000


def sampling_step(motion: Motion) -> int:
    """Return how many frames of the capture one sample of the page stands for."""
    usual, slowest = round(motion.fps / 30.0), round(motion.fps / 10.0)
    return max(1, usual, min(math.ceil(len(motion) / _MOST_SAMPLES), slowest))


def capture_data(motion: Motion, space: Space, packer: Packer) -> dict[str, Any]:
    """Describe the capture: its skeleton, its rate, its feet, its joints' positions."""
    step = sampling_step(motion)
    sampled = motion.at(np.arange(0, len(motion), step))
    points = space.points(sampled).reshape(len(sampled), -1)
    return {
        "frames": len(motion),
        "fps": round(motion.fps, 6),
        "step": step,
        "joints": motion.skeleton.n_joints,
        "bones": [astuple(bone) for bone in bones(motion.skeleton)],
        "feet": foot_spans(motion),
        "points": packer.add(points, common_step=True),
    }
