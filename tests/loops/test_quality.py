"""Figures of a cycle: zero where nothing is wrong, growing with what is."""

import dataclasses
import json

import numpy as np
import pytest

from roundelay import concatenate, find_cycles, synth
from roundelay.loops.fit import lay, npss, rmse
from roundelay.loops.quality import jerk, quality
from roundelay.output.records import cycle_record, write_json


@pytest.fixture(scope="module")
def walk() -> synth.Synthetic:
    return synth.gait("walk", repetitions=2.5, noise=0.01)


def test_figures_of_a_good_loop(walk: synth.Synthetic) -> None:
    figures = quality(find_cycles(walk.motion)[0], walk.motion)
    assert figures.seam_rotation <= figures.step_rotation * 1.2
    assert figures.seam_velocity <= figures.capture_velocity
    assert figures.loop_jerk <= figures.capture_jerk
    assert figures.loop_skate <= figures.capture_skate
    assert figures.seam_length < 0.05 * walk.motion.skeleton.size
    assert figures.coverage == 1.0
    assert figures.repetitions == pytest.approx(2.5, abs=0.05)
    # White noise of .01 rad about three axes of 18 joints.
    assert figures.template_error == pytest.approx(0.01 * np.sqrt(54), rel=0.15)
    assert figures.velocity_error < figures.acceleration_error
    assert figures.npss < 2.0


def test_figures_are_plain_numbers(walk: synth.Synthetic) -> None:
    figures = quality(find_cycles(walk.motion)[0], walk.motion)
    assert all(isinstance(value, int | float) for value in dataclasses.asdict(figures).values())


def test_a_cycle_without_evidence_is_refused(walk: synth.Synthetic) -> None:
    cycle = dataclasses.replace(find_cycles(walk.motion)[0], evidence=None)
    with pytest.raises(ValueError, match="evidence"):
        quality(cycle, walk.motion)


def test_laying_finds_the_phase(walk: synth.Synthetic) -> None:
    clean = synth.gait("walk", repetitions=2.5)
    cycle = find_cycles(clean.motion)[0]
    laid = lay(cycle, clean.motion, (30, 200))
    ahead = laid.phase - clean.phase[30:200]
    assert np.ptp(ahead) < 0.01
    assert rmse([laid], 120.0)[0] < 0.03


def test_npss_compares_frequencies() -> None:
    time = np.arange(200)[:, None] / 200
    slow, fast = np.sin(2 * np.pi * 4 * time), np.sin(2 * np.pi * 9 * time)
    assert npss(slow, slow) == 0.0
    # All power is moved by five frequencies, half of it on either side of the spectrum.
    assert npss(slow, fast) == pytest.approx(5.0, rel=1e-6)
    later = np.sin(2 * np.pi * (4.3 * time + 0.21))
    first = np.sin(2 * np.pi * 4.3 * time)
    assert npss(first, later, shift_invariant=True) < 0.5 * npss(first, later)
    assert npss(slow, slow + 3.0) > 1.0
    assert npss(slow, slow + 3.0, shift_invariant=True) == pytest.approx(0.0, abs=1e-9)


def test_jerk_of_a_cubic_is_exact() -> None:
    time = np.arange(20) / 30.0
    assert np.allclose(jerk(np.column_stack([time**3, time**2]), 30.0), [6.0, 0.0], atol=1e-6)


@pytest.mark.parametrize("frames", [1, 2, 5])
def test_a_run_too_short_for_derivatives_changes_no_other(walk: synth.Synthetic, frames) -> None:
    (cycle,) = find_cycles(walk.motion)
    ((start, stop),) = cycle.evidence.runs
    runs = ((start, stop - frames), (stop - frames, stop))
    parted = dataclasses.replace(cycle, evidence=dataclasses.replace(cycle.evidence, runs=runs))
    figures = quality(parted, walk.motion)
    assert figures.capture_jerk == pytest.approx(quality(cycle, walk.motion).capture_jerk, rel=0.05)


def test_what_cannot_be_measured_is_null_in_the_record(walk: synth.Synthetic, tmp_path) -> None:
    (cycle,) = find_cycles(walk.motion)
    figures = dataclasses.replace(quality(cycle, walk.motion), capture_jerk=float("nan"))
    write_json(cycle_record(cycle, figures), tmp_path / "walk.json")
    record = json.loads((tmp_path / "walk.json").read_text())
    assert record["quality"]["capture_jerk"] is None
    assert record["quality"]["coverage"] == 1.0


def test_a_long_capture_is_laid_like_a_short_one(walk: synth.Synthetic) -> None:
    loop = find_cycles(walk.motion)[0].sample()
    played = concatenate([loop] * (1 + 5000 // len(loop)))
    (cycle,) = find_cycles(played[: 4 * len(loop)])
    long, short = (lay(cycle, played, (7, stop)) for stop in (len(played), 4 * len(loop)))
    assert len(long.phase) > 4096 > len(short.phase)
    assert abs(long.phase[0] - short.phase[0]) <= 1 / 256
    assert np.sqrt(np.mean(long.apart**2)) == pytest.approx(
        np.sqrt(np.mean(short.apart**2)), abs=0.01
    )


def test_derivatives_of_a_few_frames_are_unknown(walk: synth.Synthetic) -> None:
    (cycle,) = find_cycles(walk.motion)
    laid = [lay(cycle, walk.motion, run) for run in ((0, 8), (20, 25))]
    values, velocity, acceleration = rmse(laid, walk.motion.fps)
    assert np.isfinite(values)
    assert np.isnan([velocity, acceleration]).all()
