"""What [C] chapter 6 leaves open, solved."""

import numpy as np
import pytest

from roundelay.phase.harmonic import design_matrix
from roundelay.reproduction.alternatives import fit_reweighted, fit_ridge, fit_turning


@pytest.fixture
def phase() -> np.ndarray:
    return np.arange(260) / 100.0


def test_ridge_shrinks_more_where_there_is_more_noise(phase: np.ndarray) -> None:
    rng = np.random.default_rng(0)
    clean = design_matrix(phase, 3) @ rng.normal(size=(7, 1))
    noisy = np.hstack([clean, clean]) + rng.normal(size=(260, 2)) * [0.01, 1.5]
    curve, penalty = fit_ridge(phase, noisy, 20)
    assert penalty[0] < penalty[1]
    assert np.sqrt(np.mean((curve(phase)[:, 0] - clean[:, 0]) ** 2)) < 0.01


def test_reweighting_ignores_a_glitch(phase: np.ndarray) -> None:
    clean = np.sin(2 * np.pi * phase)[:, None]
    broken = clean.copy()
    broken[120:126] += 2.0
    curve, weights = fit_reweighted(phase, broken, 3)
    assert np.abs(curve(phase) - clean).max() < 0.02
    assert weights[120:126].max() < 0.05
    plain = np.linalg.lstsq(design_matrix(phase, 3), broken, rcond=None)[0]
    assert np.abs(design_matrix(phase, 3) @ plain - clean).max() > 0.05


@pytest.mark.parametrize("turns", [-2, -1, 0, 1, 3])
def test_whole_turns_keep_unit_norm_and_are_continuous(phase: np.ndarray, turns: int) -> None:
    truth = 2 * np.pi * turns * phase + 0.8 * np.sin(2 * np.pi * phase)
    wrapped = np.angle(np.exp(1j * truth))[:, None]
    fitted = fit_turning(phase, wrapped, 5)
    assert fitted.turns.tolist() == [turns]
    again = fitted(phase)[:, 0]
    assert np.allclose(np.exp(1j * again), np.exp(1j * truth), atol=1e-6)
    assert np.allclose(fitted(phase + 1.0) - fitted(phase), 2 * np.pi * turns)
