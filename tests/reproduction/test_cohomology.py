"""[A] to the letter: each step beside a slow plain twin, and the whole on a made circle."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import roundelay as rl
from roundelay.base.errors import NoPeriod
from roundelay.reproduction.cohomology import centroids, count_simplices, typical_trajectory
from roundelay.reproduction.configuration import configuration, euler_angles
from roundelay.reproduction.options import TrajectoryOptions
from roundelay.reproduction.rows import trajectory_row


@pytest.fixture
def circle() -> np.ndarray:
    """Three and a half periods of 60 frames, with a little noise, in 5 dimensions."""
    phase = 2 * np.pi * np.arange(210) / 60
    waves = np.column_stack([np.cos(phase), np.sin(phase), 0.4 * np.sin(2 * phase)])
    noise = np.random.default_rng(0).normal(0.0, 0.02, (210, 5))
    return 20.0 * (np.pad(waves, ((0, 0), (0, 2))) + noise)


def test_simplices_are_cliques() -> None:
    points = np.random.default_rng(0).normal(size=(25, 2))
    apart = np.linalg.norm(points[:, None] - points, axis=-1)
    for scale in (0.0, 0.7, 1.5, 9.0):
        cliques = sum(
            all(apart[i, j] <= scale for i, j in itertools.combinations(simplex, 2))
            for size in (1, 2, 3)
            for simplex in itertools.combinations(range(25), size)
        )
        assert count_simplices(apart, scale) == cliques


@pytest.mark.parametrize("gaussian", [False, True])
def test_centroids_are_means_of_the_nearest(gaussian: bool) -> None:
    rng = np.random.default_rng(1)
    poses, phase = rng.normal(size=(40, 3)), rng.random(40)
    found = centroids(poses, phase, [0.02, 0.5, 0.99], neighbours=6, gaussian=gaussian)
    for place, centroid in zip([0.02, 0.5, 0.99], found, strict=True):
        turns = [min(abs(x - place), 1.0 - abs(x - place)) for x in phase]
        nearest = sorted(range(40), key=turns.__getitem__)[:6]
        width = turns[nearest[-1]] / 2.0
        weights = [np.exp(-0.5 * (turns[i] / width) ** 2) if gaussian else 1.0 for i in nearest]
        mean = sum(w * poses[i] for w, i in zip(weights, nearest, strict=True)) / sum(weights)
        np.testing.assert_allclose(centroid, mean)


@pytest.mark.parametrize(
    "options",
    [
        TrajectoryOptions(scale=30.0),
        TrajectoryOptions(scale=30.0, dimensions=3),
        TrajectoryOptions(scale=30.0, metric="adjacent"),
        TrajectoryOptions(scale=30.0, gaussian=True, neighbours=6),
    ],
)
def test_the_trajectory_of_a_circle(circle: np.ndarray, options: TrajectoryOptions) -> None:
    found = typical_trajectory(circle, options)
    assert abs(len(found.loop) - 60) <= 3
    assert found.centroids.shape == (500, 5)
    assert np.all(np.diff(found.places) > 0.0)
    radius = np.linalg.norm(found.loop[:, :2], axis=1)
    assert np.abs(radius - 20.0).max() < 2.0
    # The product's regression sees the same circle; a loop is closed.
    steps = np.linalg.norm(np.diff(found.loop, axis=0, append=found.loop[:1]), axis=1)
    assert steps.max() < 2.5 * np.median(steps)
    assert found.born < 5.0 if options.metric == "euclidean" else True


def test_no_class_below_the_scale_is_told(circle: np.ndarray) -> None:
    with pytest.raises(NoPeriod, match=r"no class is born below the scale 0\.1"):
        typical_trajectory(circle, TrajectoryOptions(scale=0.1))
    with pytest.raises(ValueError, match="expected at least 300 frames, one a neighbour"):
        typical_trajectory(circle, TrajectoryOptions(neighbours=300))


def test_the_root_of_a_configuration_is_its_steps(jumps: rl.Motion) -> None:
    motion = jumps[100:160]
    found = configuration(motion)
    angles = np.degrees(euler_angles(motion, motion.rotations))
    assert found.shape == (60, 3 + 3 * motion.skeleton.n_joints)
    np.testing.assert_allclose(found[:-1, :3], motion.root_path[1:] - motion.root_path[:-1])
    np.testing.assert_allclose(found[:-1, 3:6], angles[1:, 0] - angles[:-1, 0])
    np.testing.assert_allclose(found[-1, :6], found[-2, :6])
    np.testing.assert_allclose(found[:, 6:], angles[:, 1:].reshape(60, -1))


def test_a_row_of_table_1(jumps: rl.Motion) -> None:
    row = trajectory_row(jumps[1:400])
    assert {"born", "simplices", "dimensions", "cohomology_seconds", "processing_seconds"} < set(
        row
    )
    failed = trajectory_row(jumps[1:400], TrajectoryOptions(scale=1e-3))
    assert failed == {"failed": "no class is born below the scale 0.001"}
