"""[C] 3.4 with full blocks, against its equation 3.17 written out; and tests of spread."""

from __future__ import annotations

import numpy as np
import pytest

import roundelay as rl
from roundelay.cycles.models.constrained import Model, equations
from roundelay.phase.harmonic import design_matrix
from roundelay.reproduction.correlated import equal_spread, fit_correlated, unequal_shares
from roundelay.reproduction.options import ExtractionOptions
from roundelay.reproduction.raunio import PaperOptions, extract
from roundelay.reproduction.rows import extraction_rows


@pytest.fixture
def drifting() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phases, a harmonic function, and the same with errors that follow each other."""
    rng = np.random.default_rng(0)
    phase = np.arange(240) / 80.0 % 1.0
    clean = design_matrix(phase, 3) @ rng.normal(size=(7, 2))
    errors = np.zeros_like(clean)
    for frame in range(1, 240):
        errors[frame] = 0.9 * errors[frame - 1] + rng.normal(0.0, 0.05, 2)
    return phase, clean, clean + errors


def test_whitened_rows_solve_eq_3_17(drifting) -> None:
    phase, _, values = drifting
    model = Model(4)
    found = fit_correlated(phase, values, 80.0, model)
    _, designs, targets = equations(phase, values, 80.0, model)
    assert found.correlations.shape == (3, 2)
    assert 0.6 < found.correlations[0].min() < found.correlations[0].max() < 1.0
    for channel in range(2):
        inverses = []
        for group, design in enumerate(designs):
            used = design[:, np.any(design != 0.0, axis=0)]
            y = targets[group][:, channel]
            residual = y - used @ np.linalg.lstsq(used, y, rcond=None)[0]
            near = found.correlations[group, channel]
            assert near == pytest.approx(residual[1:] @ residual[:-1] / np.sum(residual[:-1] ** 2))
            new = np.append(np.sqrt(1 - near**2) * residual[0], residual[1:] - near * residual[:-1])
            variance = np.sum(new**2) / (len(new) - design.shape[1])
            lags = np.abs(np.subtract.outer(np.arange(len(y)), np.arange(len(y))))
            inverses.append(np.linalg.inv(variance * near**lags / (1 - near**2)))
        whole = np.zeros((sum(map(len, inverses)),) * 2)
        start = 0
        for block in inverses:
            whole[start : start + len(block), start : start + len(block)] = block
            start += len(block)
        x, y = np.concatenate(designs), np.concatenate([t[:, channel] for t in targets])
        literal = np.linalg.solve(x.T @ whole @ x, x.T @ whole @ y)
        curve = found.curve
        ours = np.concatenate([curve.sine, curve.cosine, curve.constant[None]])[:, channel]
        np.testing.assert_allclose(ours, literal, atol=1e-8)


def test_correlated_errors_are_outdone(drifting) -> None:
    phase, clean, values = drifting
    found = fit_correlated(phase, values, 80.0, Model(4, velocity=False, acceleration=False))
    assert np.sqrt(np.mean((found.curve(phase) - clean) ** 2)) < 0.1
    assert found.correlations.shape == (1, 2)


def test_a_channel_that_rests_stays_at_rest(drifting) -> None:
    phase, _, values = drifting
    found = fit_correlated(phase, np.column_stack([values, np.full(240, 0.7)]), 80.0, Model(4))
    np.testing.assert_allclose(found.curve(phase)[:, 2], 0.7, atol=1e-9)


def test_brown_and_forsythe_as_scipy_has_it() -> None:
    stats = pytest.importorskip("scipy.stats")
    rng = np.random.default_rng(2)
    scales = np.array([[1.0, 1.0, 1.0], [1.0, 1.4, 3.0], [1.0, 1.0, 0.2]])
    groups = [rng.normal(size=(n, 3)) * s for n, s in zip((50, 42, 61), scales, strict=True)]
    ours = equal_spread(groups)
    for channel in range(3):
        theirs = stats.levene(*(group[:, channel] for group in groups), center="median")
        assert ours[channel] == pytest.approx(theirs.pvalue, rel=1e-9)
    with pytest.raises(ValueError, match="expected 3 groups of errors, found 2"):
        equal_spread(groups[:2])


def test_weights_make_spreads_alike(drifting) -> None:
    phase, clean, _ = drifting
    noisy = clean + np.random.default_rng(3).normal(0.0, 0.02, clean.shape)
    before, after = unequal_shares(phase, noisy, 80.0, harmonics=4)
    assert before == 1.0
    assert after < before


def test_pruned_to_complete_periods() -> None:
    phase = 2 * np.pi * np.arange(170) / 60
    values = np.column_stack([np.sin(phase), np.cos(phase), 0.3 * np.sin(2 * phase)])
    whole = extract(values, PaperOptions(model=Model(3)))
    pruned = extract(values, PaperOptions(model=Model(3), complete=True))
    assert whole.period_count == pytest.approx(168 / 60, rel=0.02)
    assert pruned.period_count == pytest.approx(2.0, rel=0.02)
    assert len(pruned.phase) == pytest.approx(120, abs=2)
    single = extract(values[:70], PaperOptions(model=Model(3), complete=True))
    assert len(single.phase) == pytest.approx(60, abs=9)


def test_rows_of_the_tables(jumps: rl.Motion) -> None:
    rows = extraction_rows(jumps[1:260], ExtractionOptions(scale=5.0))
    names = {"M1", "M2", "M3", "complete", "correlated", "ridge", "reweighted", "spread"}
    assert set(rows) == names
    assert rows["M2"]["rmse"][1:] == [None, None]
    failed = extraction_rows(jumps[1:260], ExtractionOptions(scale=1e-3))
    assert {row.get("failed") for row in failed.values()} == {
        "no class is born below the scale 0.001"
    }
