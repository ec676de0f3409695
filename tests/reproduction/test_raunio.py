"""[C] to the letter: its equations by themselves, and on values whose answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from roundelay.base.errors import NoPeriod, TooShort
from roundelay.cycles.models import constrained
from roundelay.phase.harmonic import design_matrix
from roundelay.reproduction import raunio


@pytest.fixture
def turning() -> np.ndarray:
    """Three periods of 60 frames of a closed curve in 6 dimensions."""
    phase = 2 * np.pi * np.arange(180) / 60
    waves = [np.sin(phase), np.cos(phase), 0.3 * np.sin(2 * phase), 0.2 * np.cos(3 * phase)]
    return np.column_stack([*waves, waves[0] - waves[2], np.full(180, 0.7)])


def test_differences_are_exact_to_the_eighth_degree() -> None:
    x = np.arange(20) / 7.0
    velocity, acceleration = constrained.finite_differences((x**7)[:, None], 7.0)
    assert np.allclose(velocity[:, 0], 7 * x[4:-4] ** 6, rtol=1e-9, atol=1e-7)
    assert np.allclose(acceleration[:, 0], 42 * x[4:-4] ** 5, rtol=1e-8, atol=1e-6)
    with pytest.raises(TooShort):
        constrained.finite_differences(np.zeros((8, 1)), 4.0)


def test_delay_embedding_stacks_following_frames() -> None:
    rows = raunio.delay_embedding(np.arange(10.0).reshape(5, 2), 2)
    assert rows.shape == (3, 6)
    assert rows[0].tolist() == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("name", ["M1", "M2", "M3"])
def test_models_recover_a_harmonic_function(name: str) -> None:
    rng = np.random.default_rng(0)
    truth = rng.normal(size=(9, 3))
    phase = (np.arange(200) / 50.0) % 1.0
    values = design_matrix(phase, 4) @ truth
    model = replace(getattr(constrained, name), harmonics=6)
    fit = constrained.fit_model(phase, values, 50.0, model)
    assert np.allclose(fit.curve(phase), values, atol=1e-3)
    assert fit.errors[0] < 1e-3
    assert np.isnan(fit.errors[1]) == (name == "M2")


def test_m1_weighs_groups_by_their_own_noise() -> None:
    """With noise on values alone, finite differences are worse than values: small weights."""
    rng = np.random.default_rng(1)
    phase = np.arange(300) / 60.0 % 1.0
    clean = np.column_stack([np.sin(2 * np.pi * phase), np.cos(4 * np.pi * phase)])
    noisy = clean + rng.normal(scale=0.02, size=clean.shape)
    weighted = constrained.fit_model(phase, noisy, 60.0, constrained.M1)
    unweighted = constrained.fit_model(phase, noisy, 60.0, constrained.M3)
    assert np.abs(weighted.curve(phase) - clean).max() < 0.05
    assert np.abs(unweighted.curve(phase) - clean).max() > 0.05
    # What [C] claims for M1: values, velocities and accelerations fitted equally well.
    errors = weighted.errors
    assert max(errors) < 1.5 * min(errors)


def test_too_few_differences_are_not_weighed() -> None:
    """49 frames leave 41 differences for 41 coefficients: no residual, no variance, no weight."""
    values = np.random.default_rng(3).normal(size=(50, 1))
    phase = np.arange(50) / 50.0
    few, enough = (
        constrained.fit_model(phase[:n], values[:n], 50.0, constrained.M1) for n in (49, 50)
    )
    alone = constrained.fit_model(phase[:49], values[:49], 50.0, constrained.M2)
    assert np.isnan(few.errors[1:]).all()
    assert np.isfinite(enough.errors).all()
    assert np.array_equal(few.curve(phase), alone.curve(phase))


@pytest.mark.parametrize("remap", ["rank", "mixture"])
def test_extraction_finds_the_period(turning: np.ndarray, remap: str) -> None:
    found = raunio.extract(turning, raunio.PaperOptions(model=constrained.Model(5), remap=remap))
    assert found.period == pytest.approx(60.0, rel=0.02)
    assert found.period_count == pytest.approx(178 / 60, rel=0.02)
    assert found.sample().shape == (int(found.period), 6)
    error, _ = raunio.template_error(turning, found.sample())
    # The loop has the whole frames below N: up to one is lost a period.
    assert error < 0.2


def test_extraction_says_why_it_fails() -> None:
    line = np.linspace(0.0, 50.0, 60)[:, None] * np.ones(3)
    with pytest.raises(NoPeriod, match="below the scale"):
        raunio.extract(line, raunio.PaperOptions(scale=2.0))


@pytest.mark.parametrize("model", [constrained.M1, constrained.M2, constrained.M3])
def test_a_line_is_found_beside_the_harmonics(model: constrained.Model) -> None:
    """In two runs that begin at places of their own."""
    x = np.concatenate([np.arange(110), 20 + np.arange(90)]) / 50.0
    wave = np.column_stack([0.1 * np.sin(2 * np.pi * x), np.cos(4 * np.pi * x)])
    path = wave + x[:, None] * [2.0, -0.3]
    path[110:] += [5.0, -7.0]
    runs = [(0, 110), (110, 200)]
    fit = constrained.fit_model(x, path, 50.0, replace(model, harmonics=3), runs=runs, line=True)
    assert fit.slope == pytest.approx([2.0, -0.3], abs=1e-5)
    assert np.allclose(fit.curve(x) - fit.curve.constant, wave, atol=1e-5)


def test_template_matching_finds_the_offset() -> None:
    loop = np.random.default_rng(2).normal(size=(30, 4))
    capture = np.tile(loop, (3, 1))[7:80]
    error, offset = raunio.template_error(capture, loop)
    assert offset == 7
    assert error == pytest.approx(0.0, abs=1e-6)
