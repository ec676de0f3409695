"""The repetitions behind a cycle, and new ones drawn."""

import warnings

import numpy as np
import pytest
from scipy import stats

import roundelay as rl
from roundelay import synth
from roundelay.cycles.repetitions import _student
from roundelay.geometry import rotations as rot
from roundelay.motion.features import point_cloud

KNEE = "LeftLeg"


def _uneven(
    scales=(1.0, 0.8, 1.1, 0.9, 1.2, 1.0), paces=(1.1, 1.0, 1.2, 1.05, 1.15, 1.1), fps=60.0
):
    """Return a walk whose knee bends by another amplitude in each repetition, at another pace."""
    made = synth.gait("walk", repetitions=1.0, period=1.1, fps=fps)
    total = len(scales)
    phase = np.concatenate(
        [k + np.arange(round(paces[k] * fps)) / round(paces[k] * fps) for k in range(total)]
    )
    grid = np.arange(len(made.motion)) / len(made.motion)
    own = made.motion.at(np.interp(phase % 1.0, np.append(grid, 1.0), np.arange(len(grid) + 1)))
    rotations = own.rotations.copy()
    # It fades in and out within the repetition, so that nothing jumps.
    inside = phase % 1.0
    bend = (np.take(scales, phase.astype(int)) - 1.0) * np.sin(np.pi * inside) ** 2
    joint = own.skeleton.index(KNEE)
    turn = rot.from_rotation_vector(bend[:, None] * np.array([1.0, 0.0, 0.0]))
    rotations[:, joint] = rot.multiply(rotations[:, joint], turn)
    path = np.zeros_like(own.root_path)
    path[:, 1], path[:, 2] = 0.92, 1.2 * phase
    return rl.Motion(own.skeleton, rotations, path, 1.0 / fps, name="uneven")


@pytest.fixture(scope="module")
def uneven():
    motion = _uneven()
    cycle = rl.find_cycles(motion)[0]
    return cycle, motion, rl.repetitions(cycle, motion)


def test_each_repetition_is_told(uneven):
    cycle, motion, found = uneven
    assert 4 <= len(found) <= 6
    assert found.durations.mean() == pytest.approx(cycle.period, rel=0.05)
    inside = (found.phase >= 0.0) & (found.phase < 1.0)
    changed = np.linalg.norm(found.turns[:, inside], axis=-1).std(axis=0).mean(axis=0)
    assert cycle.skeleton.names[int(np.argmax(changed))] == KNEE
    own = point_cloud(motion.with_root_motion())
    for number in range(len(found)):
        shown = cycle.at(
            found.phase[inside],
            frame_time=motion.frame_time,
            change=(found.turns[number, inside], np.zeros((inside.sum(), 3)), None),
        )
        first = point_cloud(shown.with_root_motion())[0]
        at = found.starts[number]
        before = own[int(at)] + (at % 1.0) * (own[min(int(at) + 1, len(own) - 1)] - own[int(at)])
        assert np.abs(first - before).max() < 0.01


def test_a_band_holds_the_repetitions(uneven):
    _, _, found = uneven
    band = found.band(KNEE, 0.95)
    assert band.each.shape == (len(found), len(band.phase))
    middle = np.abs(band.phase - 0.5) < 0.2
    wide = (band.high - band.low)[middle].mean()
    # Amplitudes of .8 to 1.2 are 23 degrees apart.
    assert 23.0 < wide < 90.0
    narrow = found.band(KNEE, 0.5)
    assert np.all(narrow.high - narrow.low < band.high - band.low + 1e-12)
    other = found.band("RightHand", 0.95)
    assert (other.high - other.low).mean() < 0.2 * wide
    with pytest.raises(rl.SkeletonMismatch, match="no joint 'Knee'"):
        found.band("Knee", 0.95)
    with pytest.raises(ValueError, match="level between 0 and 1"):
        found.band(KNEE, 95.0)


def test_quantiles_are_those_of_student():
    for freedom in (3, 5, 10, 40):
        assert _student(0.95, freedom) == pytest.approx(stats.t.ppf(0.975, freedom), rel=0.02)


def _bends(motion):
    points = point_cloud(motion.with_root_motion())
    around = np.concatenate([points[-2:], points, points[:2]])
    accelerations = np.diff(around, n=2, axis=0).reshape(len(points) + 2, -1, 3)
    return np.linalg.norm(accelerations, axis=2).max(axis=1)


def test_drawn_repetitions_loop_without_a_seam(uneven):
    _, _, found = uneven
    bends = _bends(found.vary(3, rng=4))
    joined = np.r_[bends[:2], bends[-2:]]
    assert joined.max() <= 1.1 * bends[2:-2].max()


def test_draws_differ_by_seed_and_vary_as_the_capture_does(uneven):
    cycle, motion, found = uneven
    assert not np.allclose(
        found.vary(1, rng=1).rotations[:40], found.vary(1, rng=2).rotations[:40], atol=1e-3
    )
    assert np.array_equal(found.vary(2, rng=3).rotations, found.vary(2, rng=3).rotations)
    drawn = found.vary(120, rng=5, foot_lock=False)
    joint = cycle.skeleton.index(KNEE)
    seen = motion.rotations[cycle.evidence.runs.frames, joint]
    spread = [
        np.std(np.linalg.norm(rot.vector_between(rot.mean(seen), own), axis=-1))
        for own in (seen, drawn.rotations[:, joint])
    ]
    assert spread[1] == pytest.approx(spread[0], rel=0.25)
    still = found.vary(2, amount=0.0, foot_lock=False)
    mean = cycle.sample(periods=2, foot_lock=False)
    assert len(still) == pytest.approx(len(mean), abs=1)
    count = min(len(still), len(mean))
    assert (
        np.degrees(rot.angle_between(still.rotations[:count], mean.rotations[:count])).max() < 3.0
    )


def test_play_goes_on_and_never_repeats(uneven):
    cycle, _, found = uneven
    played = found.play(10.0, rng=0)
    assert played.duration == pytest.approx(10.0, abs=0.02)
    count = round(cycle.period * played.fps)
    first, second = played.rotations[:count], played.rotations[3 * count : 4 * count]
    assert np.degrees(rot.angle_between(first, second)).max() > 1.0
    assert np.linalg.norm(np.diff(played.root_path, axis=0), axis=1).max() < 0.1


def test_points_vary_too():
    motion = _uneven()
    points = synth.as_points(motion)
    cycle = rl.find_cycles(points)[0]
    from roundelay.motion.floating import motion_of_points

    found = rl.repetitions(cycle, motion_of_points(points))
    drawn = found.vary(2, rng=1)
    assert drawn.skeleton.free
    assert drawn.translations is not None
    assert np.isfinite(drawn.positions()).all()


def test_one_repetition_does_not_vary():
    made = synth.gait("walk", repetitions=1.9, fps=60.0)
    cycle = rl.find_cycles(made.motion)[0]
    found = rl.repetitions(cycle, made.motion)
    assert len(found) == 1
    for ask in (lambda: found.vary(), lambda: found.play(2.0), lambda: found.band(KNEE, 0.9)):
        with pytest.raises(rl.TooShort, match=r"several whole repetitions .*, found 1"):
            ask()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        blended = rl.blend([cycle, cycle], weights=[0.5, 0.5])
    with pytest.raises(ValueError, match="with its evidence"):
        rl.repetitions(blended, made.motion)
