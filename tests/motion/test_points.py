"""Points: what they hold and refuse, and the motion that is made of them."""

import warnings

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.base.errors import GapsFilled
from roundelay.motion.floating import motion_of_points, points_of_motion


def _walk(**hidden):
    made = synth.gait("walk", repetitions=6.0, fps=60.0)
    return made, synth.as_points(made.motion, **hidden)


def _quiet(points, **how):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GapsFilled)
        return motion_of_points(points, **how)


def test_what_is_not_finite_is_missing():
    positions = np.zeros((4, 2, 3))
    positions[1, 0, 2] = np.nan
    points = rl.Points.from_array(positions, fps=30.0, names=["a", "b"])
    assert points.missing.sum() == 1
    assert points.missing[1, 0]
    assert np.isnan(points.to_array()[1, 0]).all()
    assert np.isfinite(points.positions).all()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"positions": np.zeros((4, 3, 3))}, "shape"),
        ({"names": ["a", "a"]}, "'a' twice"),
        ({"fps": 0.0}, "positive frame rate"),
        ({"missing": np.zeros((3, 2), bool)}, "missing"),
        ({"likelihoods": np.zeros(4)}, "likelihoods"),
        ({"links": [(0, 2)]}, "links"),
    ],
)
def test_nonsense_is_refused(change, told):
    given = {"positions": np.zeros((4, 2, 3)), "fps": 30.0, "names": ["a", "b"]} | change
    with pytest.raises(ValueError, match=told):
        rl.Points.from_array(given.pop("positions"), **given)


def test_parts_keep_what_belongs_to_them():
    values = np.arange(24.0).reshape(4, 2, 3)
    points = rl.Points.from_array(
        values, fps=30.0, names=["a", "b"], likelihoods=np.ones((4, 2)), links=[(0, 1)]
    )
    assert len(points[1:3]) == 2
    turned = points.select(["b", "a"])
    assert turned.links == ((1, 0),)
    assert np.array_equal(turned.positions, values[:, ::-1])
    assert points.select(["b"]).links == ()
    with pytest.raises(rl.SkeletonMismatch, match="no point 'c'"):
        points.select(["c"])


@pytest.mark.parametrize("dimensions", [2, 3])
def test_points_come_back_as_they_were(dimensions):
    _, points = _walk(dimensions=dimensions)
    again = points_of_motion(motion_of_points(points))
    assert again.names == points.names
    assert again.units == points.units
    assert np.allclose(again.positions, points.positions, atol=1e-12)


def test_joints_of_a_skeleton_are_points():
    made, points = _walk()
    assert points.names == made.motion.skeleton.names
    assert np.allclose(points.positions, made.motion.positions())


def test_the_frame_goes_with_the_trunk():
    made, points = _walk()
    motion = motion_of_points(points)
    assert motion.skeleton.free
    assert {"LeftHand", "LeftFoot"}.isdisjoint(
        name
        for name, parent in zip(motion.skeleton.names, motion.skeleton.parents, strict=True)
        if parent == 0
    )
    travelled = motion.root_path[-1] - motion.root_path[0]
    assert np.allclose(travelled, made.motion.root_path[-1] - made.motion.root_path[0], atol=0.05)


def test_a_body_of_points_has_a_mirror():
    _, points = _walk()
    motion = motion_of_points(points)
    again = motion.mirror().mirror()
    assert np.allclose(again.positions(), motion.positions(), atol=1e-9)
    left = points.names.index("LeftHand")
    right = points.names.index("RightHand")
    seen = points_of_motion(motion.mirror()).positions
    assert np.allclose(seen[:, left], points.positions[:, right] * (-1.0, 1.0, 1.0), atol=0.02)


@pytest.mark.parametrize("up", [1, 2])
def test_the_axis_that_points_up_is_found(up):
    _, points = _walk()
    turned = np.roll(points.positions, up - 1, axis=2)
    found = motion_of_points(rl.Points.from_array(turned, fps=60.0, names=points.names))
    assert found.up == up


def test_an_animal_seen_from_above_has_no_heading():
    made = synth.gait("trot", repetitions=6.0, fps=60.0, turning=1.0)
    seen = points_of_motion(made.motion).positions[..., [0, 2]]
    above = rl.Points.from_array(seen, fps=60.0, names=made.motion.skeleton.names)
    motion = motion_of_points(above)
    assert motion.up == 2
    straight = synth.gait("trot", repetitions=6.0, fps=60.0)
    side = synth.as_points(straight.motion, dimensions=2)
    assert motion_of_points(side).up == 1


def test_gaps_are_filled_and_told():
    _, whole = _walk()
    _, points = _walk(gaps=0.2)
    with pytest.warns(GapsFilled, match=r"gaps of .* filled; the longest"):
        motion = motion_of_points(points)
    off = np.linalg.norm(points_of_motion(motion).positions - whole.positions, axis=2)
    assert np.sqrt(np.mean(off[points.missing] ** 2)) < 0.02
    lines = _quiet(points, fill=False)
    straight = np.linalg.norm(points_of_motion(lines).positions - whole.positions, axis=2)
    assert straight[points.missing].mean() > 2.0 * off[points.missing].mean()


def test_long_gaps_stay_open_where_asked():
    _, points = _walk(gaps=0.2)
    motion = _quiet(points, max_gap=0.15)
    gaps = motion.skeleton.layout.gaps
    assert {gap.way for gap in gaps if len(gap) > 9} == {"open"}
    assert any(gap.way != "open" for gap in gaps)
    assert motion.missing is not None
    assert motion[10:20].missing is None or len(motion[10:20].missing) == 10


def test_what_jumps_off_and_back_is_no_place():
    _, whole = _walk()
    _, points = _walk(outliers=0.02)
    off = np.linalg.norm(points.positions - whole.positions, axis=2) > 1e-9
    mended = points_of_motion(_quiet(points)).positions
    left = np.linalg.norm(mended - whole.positions, axis=2)
    assert np.linalg.norm(points.positions - whole.positions, axis=2).max() > 0.5
    assert np.quantile(left[off], 0.95) < 0.05
    assert left[~off].max() < 0.05


def test_unlikely_keypoints_are_gaps():
    _, points = _walk(dimensions=2)
    likely = np.ones(points.positions.shape[:2])
    likely[30:40, 3] = 0.1
    told = rl.Points.from_array(
        points.positions, fps=60.0, names=points.names, likelihoods=likely, image=True
    )
    gaps = _quiet(told).skeleton.layout.gaps
    assert [(gap.point, gap.start, gap.stop) for gap in gaps] == [(points.names[3], 30, 40)]


def test_nobody_in_the_picture_is_no_motion():
    _, points = _walk()
    positions = points.to_array()
    positions[:40] = np.nan
    motion = _quiet(rl.Points.from_array(positions, fps=60.0, names=points.names))
    assert not motion.shown[:39].any()
    assert motion.shown[41:].all()
    told = rl.understand(motion)
    assert min(start for each in told.cyclic for start, _ in each.spans) >= 38
    assert [each.spans for each in told.behaviours if each.kind == "unseen"] == [((0, 40),)]


def test_points_never_seen_together_are_too_short():
    positions = np.full((30, 4, 3), np.nan)
    for point in range(4):
        positions[point::4, point] = 1.0 * point
    with pytest.raises(rl.TooShort, match="of the trunk are seen"):
        motion_of_points(rl.Points.from_array(positions, fps=30.0))


@pytest.mark.parametrize(
    ("kind", "dimensions"), [("trot", 3), ("trot", 2), ("run", 2), ("walk", 3)]
)
def test_periods_of_points_are_found(kind, dimensions):
    made = synth.gait(kind, repetitions=6.3, fps=60.0, noise=0.01, rng=1)
    points = synth.as_points(
        made.motion, dimensions=dimensions, gaps=0.2, outliers=0.02, noise=0.004, rng=1
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GapsFilled)
        loops = rl.make_loops(points)
    assert loops[0].cycle.period == pytest.approx(made.period, rel=0.02)
    again = points_of_motion(loops[0].motion)
    assert again.names == points.names
    assert again.dimensions == dimensions


def test_everything_else_takes_points():
    made, points = _walk()
    timeline = rl.understand(points)
    assert timeline.cyclic[0].period == pytest.approx(made.period, rel=0.02)
    assert rl.find_periodic(points)
    cut = rl.segment(points, timeline=timeline)
    assert len(cut.segments) == 1
    assert cut.segments[0].period == pytest.approx(made.period, rel=0.02)
    first, second = (rl.find_cycles(_walk()[1])[0] for _ in range(2))
    assert rl.cycle_distance(first, second) < 1e-6
    assert rl.blend([first, second], weights=[0.5, 0.5]).period == pytest.approx(
        made.period, rel=0.02
    )


def test_takes_of_other_points_are_blended_by_those_in_common():
    made, points = _walk()
    slower = synth.gait("walk", repetitions=6.0, fps=60.0, period=1.3, rng=3)
    names = ["LeftToe" if name == "Head" else name for name in points.names]
    others = synth.as_points(slower.motion, rng=1)
    others = rl.Points.from_array(others.positions, fps=60.0, names=names, units="m")
    first, second = (rl.find_cycles(one)[0] for one in (points, others))
    mixed = rl.blend([first, second], weights=[0.5, 0.5])
    assert set(mixed.skeleton.names[1:]) == set(points.names) - {"Head"}
    assert mixed.period == pytest.approx(np.sqrt(made.period * 1.3), rel=0.02)
    alone = rl.blend([first, second], weights=[1.0, 0.0]).sample()
    shown = points_of_motion(alone)
    truth = points_of_motion(first.sample()).select(shown.names)
    assert np.allclose(shown.positions, truth.positions, atol=1e-6)
    assert rl.cycle_distance(first, second) == pytest.approx(
        rl.cycle_distance(second, first), abs=0.01
    )


def test_takes_in_other_units_are_not_blended():
    _, points = _walk()
    first = rl.find_cycles(points)[0]
    millimetres = rl.Points.from_array(
        1000.0 * points.positions, fps=60.0, names=points.names, units="mm"
    )
    with pytest.raises(ValueError, match="one unit of length, found m and mm"):
        rl.blend([first, rl.find_cycles(millimetres)[0]], weights=[0.5, 0.5])


def test_a_body_hidden_for_a_while_is_unseen_and_in_no_behaviour():
    _, points = _walk()
    positions = points.to_array()
    hidden = (len(positions) // 2 - 90, len(positions) // 2 + 90)
    positions[slice(*hidden)] = np.nan
    motion = _quiet(rl.Points.from_array(positions, fps=60.0, names=points.names))
    told = rl.understand(motion)
    assert [each.spans for each in told.behaviours if each.kind == "unseen"] == [(hidden,)]
    for each in told.cyclic:
        assert each.spans.within(range(*hidden)) == 0
    parts = rl.segment(motion, timeline=told, n_segments=3).segments
    covered = [each.kind for each in parts if hidden[0] < each.start and each.stop < hidden[1]]
    assert set(covered) <= {"unseen"}
    assert "held" not in {each.kind for each in parts}


@pytest.mark.parametrize("turn", [0.0, 4.0])
def test_legs_alone_have_a_frame_that_stays_upright(jumps, turn):
    legs = {"UpLeg": "hip", "Leg": "knee", "Foot": "heel", "ToeBase": "foot_index"}
    chosen = [f"{side}{name}" for side in ("Left", "Right") for name in legs]
    names = [f"{side}_{name}" for side in ("left", "right") for name in legs.values()]
    x, y, z = jumps.positions()[:, jumps.skeleton.indices(chosen)].transpose(2, 0, 1)
    angle = np.linspace(0.0, turn, len(jumps))[:, None]
    c, s = np.cos(angle), np.sin(angle)
    turned = np.stack([c * x + s * z, y, c * z - s * x], axis=2)
    motion = _quiet(rl.Points.from_array(turned, fps=jumps.fps, names=names))
    assert np.linalg.norm(motion.rotations[:, 0, [1, 3]], axis=1).max() < 0.2
    known, found = ({each.period for each in rl.understand(one).cyclic} for one in (jumps, motion))
    assert found
    assert all(min(abs(one / period - 1.0) for one in known) < 0.05 for period in found)


def test_zeros_of_several_points_at_once_are_gaps():
    _, points = _walk()
    positions = points.to_array()
    positions[30:40, :2] = 0.0
    positions[50:54, 4] = 0.0
    gaps = _quiet(rl.Points.from_array(positions, fps=60.0, names=points.names))
    found = {(gap.point, gap.start, gap.stop) for gap in gaps.skeleton.layout.gaps}
    first, second, fifth = (points.names[place] for place in (0, 1, 4))
    assert found >= {(first, 30, 40), (second, 30, 40), (fifth, 50, 54)}


def test_one_point_that_is_always_at_the_origin_is_a_place():
    _, points = _walk()
    positions = points.positions - points.positions[:, :1]
    with warnings.catch_warnings():
        warnings.simplefilter("error", GapsFilled)
        motion = motion_of_points(rl.Points.from_array(positions, fps=60.0, names=points.names))
    assert points.names[0] in motion.skeleton.names


def test_points_are_cut_where_their_skeleton_is(captures):
    motion = rl.read(captures / "01_03.bvh")
    points = rl.Points.from_array(
        motion.positions(), fps=motion.fps, names=motion.skeleton.names, units="m"
    )
    found = rl.segment(_quiet(points))
    known = rl.segment(motion).cuts
    near = [min(abs(one - cut) for one in known) <= 0.5 * motion.fps for cut in found.cuts]
    assert len(found) >= 4
    assert all(near)
