"""The default's parts: exact search, labels, running sums."""

import numpy as np
import pytest

from roundelay.segmentation import gaussian
from roundelay.segmentation.gaussian import GaussianOptions, gaussian_cuts
from roundelay.segmentation.model import GaussianModel
from roundelay.segmentation.moments import Moments, principal_axes
from roundelay.segmentation.thresholds import GAUSSIAN


def model_of(capture):
    motion = capture.motion
    return GaussianModel(2 * motion.rotations[:, 1:].reshape(len(motion), -1), 120.0, 0.15)


def brute_force(model, shortest, evidence):
    """Optimal partition without pruning, O(n^2)."""
    grid, least = gaussian._grid(model, shortest, 0, len(model))
    penalty = evidence * model.penalty
    best, previous = [-penalty], [0]
    for stop in range(1, len(grid)):
        starts = [s for s in range(stop - least + 1) if s == 0 or s >= least]
        totals = [best[s] + model.cost_between(grid[s], grid[stop]) + penalty for s in starts]
        best.append(min(totals, default=np.inf))
        previous.append(starts[int(np.argmin(totals))] if totals else 0)
    cuts, place = [], previous[-1]
    while place:
        cuts.append(int(grid[place]))
        place = previous[place]
    return cuts[::-1]


@pytest.mark.parametrize("evidence", [0.02, 0.1, 0.3, 1.0, 3.0])
def test_pruned_search_is_exact(capture, evidence):
    model = model_of(capture)
    assert gaussian.search(model, 1.0, evidence) == brute_force(model, 1.0, evidence)


def test_cuts_keep_the_shortest_segment(capture):
    model = model_of(capture)
    cuts = gaussian_cuts(model, GaussianOptions(sensitivity=20.0))
    assert np.diff([0, *cuts, len(model)]).min() >= model.fps * 1.0


def test_forgetting_keeps_recent_and_best():
    reached, age = np.arange(200.0), np.linspace(100.0, 0.0, 200)
    keep = gaussian._remembered(reached, age)
    old = age > GAUSSIAN.memory
    assert keep[~old].all()
    assert np.flatnonzero(keep[old]).tolist() == list(range(GAUSSIAN.veterans))


def test_costs_of_any_frames_are_those_of_their_covariance(capture):
    """Sums are kept of blocks, and the rest is added."""
    model = model_of(capture)
    places = np.array([0, 1, 9, 10, 11, 57, 100, len(model) - 1])
    stops = np.array([31, 45, 29, 40, 400, 90, 131, len(model)])
    found = model.cost_between(places, stops)
    for start, stop, value in zip(places, stops, found, strict=True):
        part = model.points[start:stop]
        covariance = np.cov(part.T, bias=True)
        assert value == pytest.approx(model.cost(float(len(part)), covariance), rel=1e-9)
    assert model.cost_between(3, stops[-1]).shape == ()


@pytest.mark.parametrize("shape", [(50, 7), (30, 90), (900, 700)])
def test_principal_axes_are_those_of_the_covariance(shape):
    """With few values, few channels, and so many that only the largest are found."""
    rng = np.random.default_rng(0)
    spread = np.exp(-0.2 * np.arange(shape[1]))
    values = rng.normal(size=shape) * spread @ np.linalg.qr(rng.normal(size=(shape[1],) * 2))[0]
    variances, axes = principal_axes(values)
    right = np.linalg.eigvalsh(np.cov(values.T, bias=True))[::-1]
    count = min(len(variances), 25)
    np.testing.assert_allclose(variances[:count], right[:count], rtol=1e-8, atol=1e-14)
    np.testing.assert_allclose(axes.T @ axes, np.eye(len(variances)), atol=1e-9)
    along = (values - values.mean(axis=0)) @ axes[:, :count]
    np.testing.assert_allclose(along.var(axis=0), right[:count], rtol=1e-8, atol=1e-14)


def test_moments_agree_with_numpy():
    values = np.random.default_rng(1).normal(size=(107, 4))
    for block in (1, 10):
        count, mean, covariance = Moments.of(values, block).between(2, 7)
        part = values[2 * block : 7 * block]
        assert count == len(part)
        np.testing.assert_allclose(mean, part.mean(axis=0), atol=1e-13)
        np.testing.assert_allclose(covariance, np.cov(part.T, bias=True), atol=1e-13)


def test_correlation_time_of_a_known_process():
    # x_t = a x_{t-1} + e has integrated autocorrelation time (1 + a) / (1 - a).
    from roundelay.segmentation.model import _correlation_time

    rng, a = np.random.default_rng(2), 0.8
    x = np.zeros((60000, 1))
    for t in range(1, len(x)):
        x[t] = a * x[t - 1] + rng.normal()
    assert _correlation_time(x, 300) == pytest.approx(9.0, rel=0.15)


@pytest.mark.parametrize("option", ["sensitivity", "resolution", "shortest"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
def test_options_must_be_positive(option, value):
    with pytest.raises(ValueError, match=option):
        GaussianOptions(**{option: value})


def test_sensitivity_and_a_number_do_not_go_together():
    with pytest.raises(ValueError, match="--sensitivity or --segments"):
        GaussianOptions(sensitivity=2.0, n_segments=3)
