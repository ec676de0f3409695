"""Structure to time: the phase found against the phase made."""

import numpy as np
import pytest

from roundelay import find_cycles, synth
from roundelay.motion.features import point_cloud
from roundelay.phase.phase_map import mixture_remap, rank_remap
from roundelay.phase.tempo import agreement_period, time_phase
from roundelay.phase.unwrap import unwrap
from roundelay.pipeline import find_periodic


def off_by(phase: np.ndarray, truth: np.ndarray) -> float:
    """RMS difference of phases in turns, at the best offset."""
    apart = phase - truth
    apart -= np.angle(np.mean(np.exp(2j * np.pi * apart))) / (2 * np.pi)
    return float(np.sqrt(np.mean((apart - np.round(apart)) ** 2)))


@pytest.mark.parametrize("repetitions", [1.3, 1.5, 2.5])
@pytest.mark.parametrize("kind", ["walk", "run"])
def test_incomplete_periods_do_not_bias_time(kind: synth.Gait, repetitions: float) -> None:
    made = synth.gait(kind, repetitions=repetitions, unevenness=0.5, noise=0.01)
    points = point_cloud(made.motion)
    found = find_periodic(made.motion)[0]
    (start, stop), frame_time = found.runs[0], made.motion.frame_time
    phase = time_phase(points, found.turns, found.runs, frame_time=frame_time)[start:stop]
    truth, structure = made.phase[start:stop], found.turns[start:stop]
    ours = off_by(phase, truth)
    assert ours < 0.005
    for remap in (rank_remap, mixture_remap):
        assert ours < 0.3 * off_by(remap(structure), truth)


@pytest.mark.parametrize("repetitions", [1.3, 1.5, 2.5])
def test_the_period_is_exact_to_a_fraction_of_a_frame(repetitions: float) -> None:
    made = synth.gait("walk", repetitions=repetitions, period=1.0371, unevenness=0.5)
    cycle = find_cycles(made.motion)[0]
    assert cycle.period == pytest.approx(1.0371, abs=0.3 / 120)


def test_agreement_counts_all_repetitions_and_runs() -> None:
    phase = np.arange(400) / 61.3
    poses = np.column_stack([np.sin(2 * np.pi * phase), np.cos(4 * np.pi * phase)])
    for runs in ([(0, 400)], [(0, 150), (170, 400)]):
        assert agreement_period(poses, runs, 60.0) == pytest.approx(61.3, abs=0.05)
    assert agreement_period(poses, [(0, 50)], 60.0) == 60.0


def test_a_changing_tempo_is_followed() -> None:
    """A walk that quickens by half is not one tempo: poses stay sharp."""
    made = synth.gait("walk", repetitions=8.0)
    frames = np.arange(len(made.motion) - 1.0)
    quickening = np.cumsum(np.linspace(0.8, 1.2, len(frames)))
    motion = made.motion.at(quickening[quickening < len(frames)])
    truth = np.interp(quickening[quickening < len(frames)], frames, made.phase[:-1])
    found = find_periodic(motion)[0]
    phase = time_phase(point_cloud(motion), found.turns, found.runs, frame_time=motion.frame_time)
    (start, stop) = found.runs[0]
    assert off_by(phase[start:stop], truth[start:stop]) < 0.01


def test_unwrapped_phase_runs_on_from_turn_to_turn() -> None:
    assert np.allclose(np.diff(unwrap(np.arange(50) / 20.0 % 1.0, [(0, 50)])), 0.05)


def test_the_period_is_the_lag_of_least_mean_distance() -> None:
    """Against every pair of poses by itself."""
    rng = np.random.default_rng(0)
    phase = 2 * np.pi * np.arange(700)[:, None] / 61.3
    poses = np.hstack([np.sin(phase), np.cos(2 * phase)]) + rng.normal(scale=0.3, size=(700, 2))
    runs = [(0, 300), (310, 360), (400, 700)]

    def disagreement(lag: int) -> float:
        apart = [
            np.sum((poses[start + whole : stop] - poses[start : stop - whole]) ** 2, axis=1)
            for start, stop in runs
            for whole in range(lag, stop - start, lag)
        ]
        return float(np.mean(np.concatenate(apart)))

    lags = np.arange(57, 66)
    values = np.array([disagreement(lag) for lag in lags])
    best = int(np.argmin(values))
    bend = np.polyfit([-1.0, 0.0, 1.0], values[best - 1 : best + 2], 2)
    expected = lags[best] - bend[1] / (2 * bend[0])
    assert agreement_period(poses, runs, 61.0) == pytest.approx(expected, abs=1e-6)
