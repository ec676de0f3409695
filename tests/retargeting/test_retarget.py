"""A motion on another body: known truths, characters of many programs, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from benchmarks._characters import STYLES, character, rerested
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.loops.lint import lint
from roundelay.retargeting.anatomy import Anatomy
from roundelay.retargeting.mapping import read_maps, write_maps
from roundelay.retargeting.onto import Retargeting, as_played

# A T-pose lies in front of the capture.
FRAMES = slice(130, 430)


@pytest.fixture(scope="module")
def jump(jumps):
    """A jump of CMU 01_01."""
    return jumps[FRAMES]


@pytest.fixture(scope="module")
def spar(boxing):
    """Some steps of sparring, of another skeleton."""
    return boxing[600:900]


def mapped_places(motion: rl.Motion) -> np.ndarray:
    """Return where the joints of the canonical body are."""
    body = rl.map_body(motion)
    return motion.positions()[:, list(body.indices(motion.skeleton).values())]


def angles(motion: rl.Motion) -> np.ndarray:
    """Return the angles of knees and elbows in degrees."""
    anatomy, places = Anatomy(motion.skeleton, rl.map_body(motion)), motion.positions()
    found = []
    for limb in anatomy.limbs:
        top, middle, end = (places[:, j] for j in (limb.upper[0], limb.lower[0], limb.end))
        one, two = middle - top, end - middle
        cosine = np.sum(one * two, axis=1) / np.linalg.norm(one, axis=1)
        found.append(np.degrees(np.arccos(np.clip(cosine / np.linalg.norm(two, axis=1), -1, 1))))
    return np.stack(found, axis=1)


@pytest.mark.parametrize("take", ["jump", "spar"])
def test_onto_its_own_skeleton_nothing_changes(take, request):
    motion = request.getfixturevalue(take)
    again = rl.retarget(motion, motion.skeleton)
    apart = np.linalg.norm(mapped_places(again) - mapped_places(motion), axis=2)
    assert apart.max() < 0.004 * motion.skeleton.size
    assert np.median(apart) < 1e-6 * motion.skeleton.size
    assert again.name == motion.name
    assert again.fps == motion.fps


def test_onto_a_larger_one_all_grows(jump):
    again = rl.retarget(jump, jump.skeleton.scaled(5.6))
    apart = np.linalg.norm(mapped_places(again) - 5.6 * mapped_places(jump), axis=2)
    assert np.median(apart) < 1e-6 * again.skeleton.size
    assert apart.max() < 0.004 * again.skeleton.size


@pytest.mark.parametrize("lowered", [0.0, 45.0, 80.0])
def test_the_pose_at_rest_does_not_matter(jump, lowered):
    """A twin at rest with its arms lowered does exactly the same."""
    skeleton = jump.skeleton
    pose = rot.identity(skeleton.n_joints)
    for name, sign in (("LeftArm", -1.0), ("RightArm", 1.0)):
        turn = np.array([0.0, 0.0, sign * np.radians(lowered)])
        pose[skeleton.index(name)] = rot.from_rotation_vector(turn)
    twin = rerested(jump, pose)
    assert np.allclose(twin.positions(), jump.positions())
    again = rl.retarget(jump, twin.skeleton)
    apart = np.linalg.norm(mapped_places(again) - mapped_places(jump), axis=2)
    assert apart.max() < 0.004 * skeleton.size
    turns, truth = (
        forward_kinematics(m.skeleton, m.rotations)[1][:, skeleton.index("LeftArm")]
        for m in (again, twin)
    )
    assert np.degrees(rot.angle_between(turns, truth).max()) < 1.0


@pytest.mark.parametrize("style", STYLES)
def test_characters_of_many_programs(style, spar):
    made = character(style)
    body = rl.map_body(made)
    assert body.kind == "biped"
    assert body.missing == ()
    again = rl.retarget(spar, made)
    assert again.skeleton.names == made.skeleton.names
    assert again.up == made.up
    assert again.skeleton.figure is made.skeleton.figure
    # Bones point where they pointed; legs give a little for feet of another length.
    ours, theirs = angles(spar), angles(again)
    assert np.sqrt(np.mean((ours - theirs) ** 2)) < 6.0
    bones = [("upper arm", "lower arm"), ("lower arm", "hand"), ("upper leg", "lower leg")]
    for side in ("left", "right"):
        for start, stop in bones:
            ways = []
            for motion in (spar, again):
                at = rl.map_body(motion).indices(motion.skeleton)
                places = rot.rotate(rot.axis_to_y(motion.up), motion.positions())
                way = places[:, at[f"{side} {stop}"]] - places[:, at[f"{side} {start}"]]
                ways.append(way / np.linalg.norm(way, axis=1, keepdims=True))
            assert np.median(np.sum(ways[0] * ways[1], axis=1)) > np.cos(np.radians(6.0))


def test_feet_stand_where_they_stood(jump):
    made = character("mixamo")
    carrying = Retargeting.between(jump, made)
    again = carrying(jump)
    scale = carrying.target.leg_length / carrying.source.leg_length
    balls = [
        motion.positions()[:, motion.skeleton.index(name)]
        for motion, name in ((jump, "LeftToeBase"), (again, "mixamorig:LeftToeBase"))
    ]
    still = np.linalg.norm(np.diff(balls[0], axis=0), axis=1) < 2e-4 * jump.skeleton.size
    assert still.sum() > 30
    ours, theirs = (np.diff(ball, axis=0)[still] for ball in balls)
    assert np.abs(theirs - scale * ours).max() < 1e-3 * made.skeleton.size
    way = again.root_path[-1] - again.root_path[0]
    assert np.allclose(
        way[[0, 2]], scale * (jump.root_path[-1] - jump.root_path[0])[[0, 2]], rtol=0.05
    )
    lowest = balls[1][:, 1].min()
    assert lowest > -0.02 * made.skeleton.size


def test_a_spine_of_other_number_shares_the_bend(jump):
    """Five joints of a spine bend as much as three together, each by less."""
    made = character("unreal")
    again = rl.retarget(jump, made)
    spines = (["Hips", "LowerBack", "Spine", "Spine1"],
              ["pelvis", *(f"spine_{n:02d}" for n in range(1, 6))])  # fmt: skip
    whole, parts = [], []
    for motion, rest, names in zip((jump, again), (None, made), spines, strict=True):
        at = motion.skeleton.indices(names)
        turns = forward_kinematics(motion.skeleton, motion.rotations)[1][:, at]
        if rest is not None:
            still = forward_kinematics(made.skeleton, made.rotations)[1][:, at]
            turns = rot.multiply(turns, rot.conjugate(still))
        whole.append(rot.angle_between(turns[:, -1], turns[:, 0]))
        parts.append(rot.angle_between(turns[:, 1:], turns[:, :-1]).max(axis=1))
    assert np.allclose(*whole, atol=1e-6)
    assert np.mean(parts[1]) < np.mean(parts[0])


def test_a_twist_is_shared_out():
    """Joints beside a forearm turn with the hand, but less."""
    made = character("unreal")
    skeleton = made.skeleton
    turned = made.rotations[0].copy()
    hand = skeleton.index("hand_l")
    about = rot.from_rotation_vector(np.radians(80.0) * np.array([1.0, 0.0, 0.0]))
    turned[hand] = rot.multiply(about, turned[hand])
    rotations = np.stack([made.rotations[0], turned])
    motion = replace(made, rotations=rotations, root_path=made.root_path[[0, 0]])
    again = rl.retarget(motion, made)
    assert np.allclose(again.positions()[:, hand], motion.positions()[:, hand])
    for name, share in (("lowerarm_twist_01_l", 0.5), ("lowerarm_twist_02_l", 0.66)):
        pair = again.rotations[:, skeleton.index(name)]
        assert np.degrees(rot.angle_between(*pair)) == pytest.approx(80.0 * share, abs=1.0)


def test_a_loop_stays_a_loop(jump_loops):
    loop = jump_loops[0].motion
    again = rl.retarget(loop, character("rigify"))
    assert len(again) == len(loop)
    assert {fault.name for fault in lint(again, False)} <= {
        fault.name for fault in lint(loop, False)
    }
    wrapped = as_played(again, True)
    assert len(wrapped) == len(again) + 1
    assert np.allclose(wrapped.rotations[-1, 1:], wrapped.rotations[0, 1:])
    assert len(as_played(wrapped, False)) == len(again)


def test_hands_on_the_hips_stay_there():
    """A body with longer arms and other hips puts its hands on its own."""
    made = character("unity", meshes=False)
    at = rl.map_body(made).indices(made.skeleton)
    akimbo = made.rotations[0].copy()
    places, turns = forward_kinematics(made.skeleton, akimbo[None])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for part, turn in (
            ("upper arm", (0.0, 0.0, -0.9 * sign)),
            ("lower arm", (0.0, 0.0, -2.0 * sign)),
        ):
            joint = at[f"{side} {part}"]
            above = turns[0, made.skeleton.parents[joint]]
            about = rot.rotate(rot.conjugate(above), np.array(turn))
            akimbo[joint] = rot.multiply(rot.from_rotation_vector(about), akimbo[joint])
            places, turns = forward_kinematics(made.skeleton, akimbo[None])
    still = replace(
        made, rotations=np.tile(akimbo, (40, 1, 1)), root_path=np.tile(made.root_path, (40, 1))
    )
    hips = places[0, [at["left upper leg"], at["right upper leg"]]]
    carrying = Retargeting.between(still, character("vrm"))
    again = carrying(still)
    near = []
    for motion, anatomy in ((still, carrying.source), (again, carrying.target)):
        own = motion.positions()[20] / anatomy.leg_length
        middle = own[list(anatomy.hips)].mean(axis=0)
        near.append(np.linalg.norm(own[anatomy.at["left hand"]] - middle))
    assert hips.shape == (2, 3)
    assert near[1] == pytest.approx(near[0], abs=0.05)


def test_a_map_is_kept_and_edited(tmp_path, jump):
    body = rl.map_body(jump)
    write_maps({"capture": body}, tmp_path / "map.json")
    assert read_maps(tmp_path / "map.json")["capture"].joints == dict(body.joints)
    told = json.loads((tmp_path / "map.json").read_text())
    told["capture"]["joints"]["head"] = "Neck1"
    (tmp_path / "map.json").write_text(json.dumps(told))
    edited = read_maps(tmp_path / "map.json")["capture"]
    assert edited.joints["head"] == "Neck1"
    assert len(rl.retarget(jump[:20], character("vrm"), source_map=edited)) == 20


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "expected JSON"),
        ("[]", "expected"),
        ("{}", "expected 'capture' or 'character'"),
        ('{"capture": {"joints": {"hips": 3}}}', "a name for each joint"),
        (
            '{"capture": {"joints": {"hips": "Hips"}}}',
            "expected a joint for each of left upper arm",
        ),
        ('{"capture": {"kind": "fish", "joints": {}}}', "expected a biped or a quadruped"),
        ('{"capture": {"joints": {"wing": "Hips"}}}', "found 'wing'"),
    ],
)
def test_maps_that_are_none(tmp_path, text, told):
    (tmp_path / "map.json").write_text(text)
    with pytest.raises(rl.FormatError, match=told) as raised:
        read_maps(tmp_path / "map.json")
    assert "map.json" in str(raised.value)


def test_a_joint_that_is_not_there(jump):
    body = rl.map_body(jump)
    wrong = replace(body, joints={**body.joints, "head": "Kopf"})
    with pytest.raises(rl.SkeletonMismatch, match="no joint 'Kopf'"):
        rl.retarget(jump, jump.skeleton, source_map=wrong)


def test_what_has_no_legs_is_refused():
    names = (
        "Hips",
        "Spine",
        "LeftArm",
        "LeftForeArm",
        "LeftHand",
        "RightArm",
        "RightForeArm",
        "RightHand",
    )
    parents = (-1, 0, 1, 2, 3, 1, 5, 6)
    torso = rl.Skeleton(names, parents, np.eye(3)[[1, 1, 0, 0, 0, 0, 0, 0]] * 1.0)
    with pytest.raises(rl.SkeletonMismatch, match="found no left leg, right leg"):
        rl.map_body(torso)


def test_two_arms_on_one_side_are_told(jump):
    """Both fit equally well: which is meant has to be said."""
    skeleton, joints = jump.skeleton, ["LeftArm", "LeftForeArm", "LeftHand"]
    count = skeleton.n_joints
    parents = (*skeleton.parents, skeleton.index("LeftShoulder"), count, count + 1)
    names = (*skeleton.names, *(f"{name}2" for name in joints))
    offsets = np.concatenate([skeleton.offsets, skeleton.offsets[skeleton.indices(joints)]])
    with pytest.raises(rl.SkeletonMismatch, match=r"expected one left arm, found two.*--map"):
        rl.map_body(rl.Skeleton(names, parents, offsets))


def test_a_folded_pose_at_rest_is_told(jump):
    skeleton = jump.skeleton
    pose = rot.identity(skeleton.n_joints)
    pose[skeleton.index("LeftLeg")] = rot.from_rotation_vector(np.array([2.2, 0.0, 0.0]))
    folded = rerested(jump, pose).skeleton
    with pytest.raises(rl.SkeletonMismatch, match="the left leg does not reach down"):
        rl.retarget(jump, folded)
    # A motion of it tells what its rest does not.
    assert len(rl.retarget(jump, rerested(jump, pose))) == len(jump)


def quadruped() -> rl.Skeleton:
    """A made animal whose front legs are called so."""
    rows = [("spine", -1, (0, 1, 0)), ("chest", 0, (0, 0, 0.7)), ("neck", 1, (0, 0.2, 0.2)),
            ("head", 2, (0, 0.2, 0.2)), ("tail", 0, (0, 0, -0.2)),
            ("tail.001", 4, (0, 0, -0.2))]  # fmt: skip
    for side, x in (("L", 0.15), ("R", -0.15)):
        for end, above in (("front_", 1), ("", 0)):
            at = len(rows)
            rows += [(f"{end}thigh.{side}", above, (x, 0, 0)),
                     (f"{end}shin.{side}", at, (0, -0.5, 0)),
                     (f"{end}foot.{side}", at + 1, (0, -0.45, 0)),
                     (f"{end}toe.{side}", at + 2, (0, -0.05, 0.1))]  # fmt: skip
    names, parents, offsets = zip(*rows, strict=True)
    return rl.Skeleton(names, parents, np.array(offsets, float))


def test_an_animal_goes_onto_an_animal_alone(jump):
    animal = quadruped()
    body = rl.map_body(animal)
    assert body.kind == "quadruped"
    assert body.joints["left upper arm"] == "front_thigh.L"
    assert body.joints["tail tip"] == "tail.001"
    with pytest.raises(rl.SkeletonMismatch, match="found a biped and a quadruped"):
        rl.retarget(jump, animal)
    swing = 0.4 * np.sin(np.linspace(0.0, 6.0, 50))
    rotations = rot.identity(50, animal.n_joints)
    for name in ("front_thigh.L", "thigh.R", "tail"):
        rotations[:, animal.index(name)] = rot.from_rotation_vector(swing[:, None] * np.eye(3)[0])
    walk = rl.Motion(animal, rotations, np.tile([0.0, 1.0, 0.0], (50, 1)), 1 / 30)
    again = rl.retarget(walk, animal.scaled(2.0))
    assert np.allclose(again.positions(), 2.0 * walk.positions(), atol=0.02)


def test_markers_have_no_bones(spar):
    points = rl.Motion(
        replace(spar.skeleton, free=True), spar.rotations, spar.root_path, spar.frame_time
    )
    with pytest.raises(rl.SkeletonMismatch, match="markers or keypoints"):
        rl.retarget(points, spar.skeleton)


def test_the_command(tmp_path, captures):
    made = character("mixamo")
    rl.write(made, tmp_path / "hero.glb")

    def run(*words: str):
        return CliRunner().invoke(app, ["retarget", *map(str, words)])

    done = run(captures / "01_01.bvh", "--onto", tmp_path / "hero.glb", "-o", tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert "a biped, 22 of 22 joints found" in done.output
    again = rl.read(tmp_path / "out" / "01_01_onto.glb")
    assert again.skeleton.figure is not None
    assert len(again) == 2752
    kept = tmp_path / "out" / "01_01_onto_map.json"
    assert read_maps(kept)["character"].joints["left foot"] == "mixamorig:LeftFoot"
    done = run(captures / "01_01.bvh", "-o", tmp_path)
    assert done.exit_code == 2
    assert "expected a character" in done.output
    done = run(captures / "01_01.bvh", "--onto", tmp_path / "none.glb", "-o", tmp_path)
    assert done.exit_code == 2
    assert "none.glb" in done.output
