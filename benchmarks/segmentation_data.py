"""Captures with a person's segmentation, and captures of one behaviour."""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import roundelay as rl
from benchmarks.raunio import TABLES, find_capture
from roundelay.segmentation import Truth, joint_quaternions

FULL = ("86_01", "13_29", "13_30", "13_31", "14_06")
FOUR_CHANNELS = ("86_02", "86_07", "86_11")
# Spellings of one behaviour in [B]'s labels.
SAME = {"walk": "walking", "punch": "punching"}


@dataclass(frozen=True)
class Capture:
    """Points of a capture: quaternions times two, or joint angles; both in radians."""

    name: str
    values: np.ndarray
    fps: float
    truth: Truth
    second: tuple[int, ...] | None
    """Cuts of a second person."""
    motion: rl.Motion | None = None
    """None where only four channels are to be had."""


def labelled(data: Path) -> list[Capture]:
    """Load the captures that have labels."""
    labels = {
        name: json.loads((data / "labels" / f"{name}.json").read_text())["sequences"]
        for name in ("barbic2004", "mocap6", "time2state")
    }
    captures = []
    for name in FULL:
        motion = rl.read(data / "cmu" / "acclaim" / name[:2] / f"{name}.amc")
        captures.append(_capture(name, 2.0 * joint_quaternions(motion), labels, motion))
    for name in FOUR_CHANNELS:
        degrees = np.loadtxt(data / "cmu" / "four_channel" / f"{name}.txt")
        captures.append(_capture(f"{name} (4)", np.radians(degrees), labels))
    return captures


def single_behaviours(data: Path) -> list[rl.Motion]:
    """Read the walks and runs of [C], without the T-pose that stands before a BVH."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motions = [find_capture(data, name) for name in TABLES]
    return [motion[1:] if motion.skeleton.names[0] == "Hips" else motion for motion in motions]


def _capture(
    name: str, values: np.ndarray, labels: dict, motion: rl.Motion | None = None
) -> Capture:
    trial = name[:5]
    second = labels["time2state"].get(trial)
    cuts = tuple(start for start, _, _ in second["segments"][1:]) if second else None
    return Capture(name, values, 120.0, _truth(trial, labels), cuts, motion)


def _truth(trial: str, labels: dict) -> Truth:
    """[B]'s windows where it has them, else windows of its usual width, .83 s."""
    if trial in labels["mocap6"]:
        return Truth.around(labels["mocap6"][trial]["segments"], frame_time=1 / 120)
    entry = labels["barbic2004"][trial]
    segments = tuple((a, b, SAME.get(name, name)) for a, b, name in entry["segments"])
    # Some windows of the source leave out their own best frame.
    windows = tuple((min(e, best), max(best, late)) for _, e, best, late in entry["transitions"])
    return Truth(segments, windows, 1 / 120)
