"""The typical trajectory of [A], and the mixture it samples."""

from __future__ import annotations

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.models.centroid import centroid_cycle
from roundelay.geometry import rotations as rot
from roundelay.phase.mixture import fit_circular_mixture


@pytest.fixture(scope="module")
def made() -> synth.Synthetic:
    return synth.gait("walk", repetitions=4, noise=0.01)


def test_the_mixture_follows_the_density():
    phase = np.random.default_rng(0).vonmises(1.0, 2.0, size=4000) / (2 * np.pi) % 1.0
    mixture = fit_circular_mixture(phase)
    grid = np.linspace(0, 1, 400, endpoint=False)
    expected = np.exp(2.0 * np.cos(2 * np.pi * grid - 1.0)) / np.i0(2.0)
    assert mixture.density(grid).mean() == pytest.approx(1.0, abs=0.01)
    assert np.abs(mixture.density(grid) - expected).mean() < 0.12
    assert mixture.density([0.0, 1.0]) == pytest.approx([mixture.density([0.0])[0]] * 2, rel=0.1)


def test_quantiles_part_the_density_evenly():
    mixture = fit_circular_mixture(np.random.default_rng(1).beta(2, 5, size=500))
    places = mixture.quantiles(40)
    assert np.all(np.diff(places) > 0)
    assert np.allclose(mixture.distribution(places), (np.arange(40) + 0.5) / 40, atol=1e-3)


@pytest.mark.parametrize("gaussian", [False, True])
def test_centroids_lie_on_the_motion(made, gaussian):
    cycle = rl.find_cycles(made.motion)[0]
    typical = centroid_cycle(cycle, made.motion, gaussian=gaussian)
    poses = typical.rotations(np.arange(100) / 100)[:, 1:]
    clean = synth.gait("walk", repetitions=1).motion.rotations[:, 1:]
    apart = rot.angle_between(poses[:, None], clean[None]).mean(axis=2).min(axis=1)
    assert apart.max() < 0.03
    assert typical.period == cycle.period


@pytest.mark.parametrize("angle", [0.0, 1.0, 2.5])
def test_the_body_faces_where_it_faced(angle):
    """Its heading sways in a stride, and drifts from stride to stride."""
    made = synth.gait("walk", repetitions=3.2, turning=0.3).motion
    turn, rotations = rot.from_rotation_vector([0.0, angle, 0.0]), made.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    path = rot.rotate(turn, made.root_path)
    motion = rl.Motion(made.skeleton, rotations, path, made.frame_time)
    typical, cycle = (
        rl.find_cycles(motion, rl.Options(method=method))[0] for method in ("centroid", "harmonic")
    )
    phase = np.arange(50) / 50
    roots = [one.rotations(phase)[:, 0] for one in (typical, cycle)]
    assert rot.angle_between(*roots).max() < 0.02


def test_it_is_a_method_of_the_main_job(made):
    (cycle,) = rl.find_cycles(made.motion, rl.Options(method="centroid"))
    assert len(cycle.pose.frequencies) > 200
    with pytest.raises(ValueError, match="expected a cycle model"):
        rl.find_cycles(made.motion, rl.Options(method="magic"))


def test_bad_neighbours_are_refused(made):
    cycle = rl.find_cycles(made.motion)[0]
    with pytest.raises(ValueError, match="neighbours"):
        centroid_cycle(cycle, made.motion, neighbours=10**6)


def test_neighbours_and_weights_are_options(made):
    """Of all frames' mean nothing moves; the fewer the nearer to what was captured."""
    cycle = rl.find_cycles(made.motion)[0]
    spread = {}
    for count in (4, 60):
        options = rl.Options(method="centroid", neighbours=count, gaussian=True)
        (found,) = rl.find_cycles(made.motion, options)
        own = centroid_cycle(cycle, made.motion, neighbours=count, gaussian=True)
        phases = np.arange(48) / 48
        assert np.allclose(np.abs(found.rotations(phases)), np.abs(own.rotations(phases)), atol=0.2)
        spread[count] = float(np.std(found.rotations(phases)[:, 1:], axis=0).mean())
    assert spread[60] < spread[4]
    for given in ({"neighbours": 4}, {"gaussian": True}):
        with pytest.raises(ValueError, match="with the method 'centroid' only, found 'auto'"):
            rl.Options(**given)
