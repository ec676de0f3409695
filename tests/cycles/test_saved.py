"""Cycles written to files and read again."""

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth


@pytest.fixture(scope="module")
def walk():
    return rl.find_cycles(synth.gait("walk", turning=0.3).motion)[0]


def same(one, other):
    phase = np.linspace(-0.5, 1.5, 40)
    first, second = (cycle.at(phase, frame_time=0.1).positions() for cycle in (one, other))
    return np.array_equal(first, second)


@pytest.mark.parametrize("kind", ["walk", "spin", "trot"])
def test_a_cycle_comes_back_to_the_bit(kind, tmp_path):
    cycle = rl.find_cycles(synth.gait(kind).motion)[0]
    cycle.save(tmp_path / "cycle.npz")
    again = rl.Cycle.load(tmp_path / "cycle.npz")
    assert same(cycle, again)
    assert (again.period, again.fps, again.name, again.method, again.up) == (
        cycle.period,
        cycle.fps,
        cycle.name,
        cycle.method,
        cycle.up,
    )
    assert np.array_equal(again.phase, cycle.phase, equal_nan=True)
    assert again.evidence is None


def test_points_and_roots_that_stand_still_come_back(jumps, tmp_path):
    points = synth.as_points(synth.gait("walk").motion)
    for number, take in enumerate((points, jumps)):
        cycle = rl.find_cycles(take)[0]
        cycle.save(tmp_path / f"{number}.npz")
        again = rl.Cycle.load(tmp_path / f"{number}.npz")
        assert same(cycle, again)
        assert again.skeleton.free is cycle.skeleton.free
        rl.write(again.sample(), tmp_path / ("points.trc" if number == 0 else "jumps.bvh"))


def test_what_is_loaded_can_be_used(walk, tmp_path):
    walk.save(str(tmp_path / "walk.npz"))
    again = rl.Cycle.load(str(tmp_path / "walk.npz"))
    assert rl.cycle_distance(walk, again) < 1e-6
    assert rl.blend([walk, again], [0.5, 0.5]).period == pytest.approx(walk.period)
    assert rl.PhaseTracker(again).follow(walk.sample(periods=2))[-1].found
    with pytest.raises(ValueError, match="expected a cycle found in a capture"):
        rl.repetitions(again, synth.gait("walk").motion)


def changed(path, **arrays):
    with np.load(path) as held:
        np.savez(path.with_name("other.npz"), **{**held, **arrays})
    return path.with_name("other.npz")


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"roundelay_cycle": np.array(9)}, "expected version 1 or earlier, found 9"),
        ({"pose_sine": np.zeros((2, 3))}, r"pose_sine of shape \(2, 3\) for"),
        ({"period": np.array(-1.0)}, "period, turning and rate of -1.0"),
        ({"parents": np.full(19, 3)}, "expected one root"),
        ({"up": np.array(7)}, "axis 7 that points up"),
        ({"names": np.array([object()])}, "names"),
        ({"height_constant": np.array([np.nan])}, "a height that is not finite"),
    ],
)
def test_files_that_are_no_whole_cycle_are_refused(walk, tmp_path, arrays, said):
    walk.save(tmp_path / "walk.npz")
    with pytest.raises(rl.FormatError, match=said):
        rl.Cycle.load(changed(tmp_path / "walk.npz", **arrays))


def test_other_files_are_refused(walk, tmp_path):
    np.savez(tmp_path / "points.npz", positions=np.zeros((3, 2, 3)))
    with pytest.raises(rl.FormatError, match="expected a cycle saved by roundelay"):
        rl.Cycle.load(tmp_path / "points.npz")
    walk.save(tmp_path / "walk.npz")
    data = (tmp_path / "walk.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(data[: len(data) // 2])
    with pytest.raises(rl.FormatError, match="expected a whole NPZ"):
        rl.Cycle.load(tmp_path / "cut.npz")
    with pytest.raises(ValueError, match=r"expected a file of type \.npz, found 'walk\.json'"):
        walk.save(tmp_path / "walk.json")
