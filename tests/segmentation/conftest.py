"""A capture with known cuts: behaviours made of random harmonics, blended into each other."""

from dataclasses import dataclass

import numpy as np
import pytest

from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion
from roundelay.segmentation import STANDARD_JOINTS, Truth

FPS = 120.0


@dataclass(frozen=True)
class Capture:
    motion: Motion
    truth: Truth


def skeleton(names=STANDARD_JOINTS):
    joints = ("root", *names)
    offsets = np.tile([0.0, 1.0, 0.0], (len(joints), 1))
    return Skeleton(joints, tuple(range(-1, len(joints) - 1)), offsets)


def behaviour(rng, frames, joints):
    """Rotation vectors (frames, joints, 3): a mean pose and two harmonics of about 1 Hz."""
    time = np.arange(frames)[:, None, None] / FPS
    rate, shape = rng.uniform(0.7, 1.4), (joints, 3)
    value = rng.normal(0.0, 0.3, shape)
    for harmonic in (1, 2):
        phase = rng.uniform(0.0, 2.0 * np.pi, shape)
        size = rng.normal(0.0, 0.25 / harmonic, shape)
        value = value + size * np.sin(2.0 * np.pi * harmonic * rate * time + phase)
    return value


def make_capture(plan="abacdb", seconds=6.0, seed=0, noise=0.0, names=STANDARD_JOINTS):
    """Play the behaviours of a plan, one letter each, for `seconds` and a bit."""
    rng = np.random.default_rng(seed)
    seeds = {letter: rng.integers(1 << 30) for letter in sorted(set(plan))}
    lengths = (FPS * seconds * rng.uniform(0.8, 1.2, len(plan))).astype(int)
    parts = [
        behaviour(np.random.default_rng(seeds[letter]), length, len(names))
        for letter, length in zip(plan, lengths, strict=True)
    ]
    vectors = np.concatenate(parts)
    for cut in np.cumsum(lengths)[:-1]:
        ramp = np.linspace(0.0, 1.0, 41)[:, None, None]
        vectors[cut - 20 : cut + 21] = (1 - ramp) * vectors[cut - 21] + ramp * vectors[cut + 21]
    vectors = vectors + noise * rng.normal(size=vectors.shape)
    rotations = rot.identity(len(vectors), len(names) + 1)
    rotations[:, 1:] = rot.from_rotation_vector(vectors)
    motion = Motion(skeleton(names), rotations, np.zeros((len(vectors), 3)), 1 / FPS, name=plan)
    bounds = [0, *np.cumsum(lengths).tolist()]
    segments = list(zip(bounds[:-1], bounds[1:], plan, strict=True))
    return Capture(motion, Truth.around(segments, frame_time=1 / FPS))


@pytest.fixture(scope="session")
def capture():
    return make_capture()
