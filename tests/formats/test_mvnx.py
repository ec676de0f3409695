"""MVNX of Xsens suits."""

from __future__ import annotations

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.formats import contents_of
from roundelay.formats.mvnx import MvnxReader
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.testing import check_reader

NAMES = ("Pelvis", "L5", "L3", "RightUpperLeg", "RightLowerLeg")
PARENTS = (-1, 0, 1, 0, 3)


@pytest.fixture(scope="module")
def motion():
    """A few segments that turn, Z up."""
    rng = np.random.default_rng(0)
    offsets = np.array([[0, 0, 0], [0, 0, 0.1], [0, 0, 0.1], [0, -0.1, -0.1], [0, 0, -0.4]])
    skeleton = rl.Skeleton(NAMES, PARENTS, offsets)
    turns = rot.from_rotation_vector(np.cumsum(0.1 * rng.normal(size=(5, 5, 3)), axis=0))
    return rl.Motion(skeleton, turns, rng.normal(size=(5, 3)), 1 / 60, up=2)


def text(motion: rl.Motion, joints: bool = True, frames: int = 5) -> str:
    places, turns = forward_kinematics(motion.skeleton, motion.rotations, motion.root_path)
    rows = [
        '<frame time="0" type="tpose"><orientation>1</orientation></frame>',
        *(
            f'<frame time="{n}" type="normal"><orientation>{_row(turns[n])}</orientation>'
            f"<position>{_row(places[n])}</position></frame>"
            for n in range(frames)
        ),
    ]
    segments = "".join(f'<segment label="{name}" id="{n}"/>' for n, name in enumerate(NAMES, 1))
    links = "".join(
        f"<joint><connector1>{NAMES[parent]}/a</connector1><connector2>{name}/b</connector2></joint>"
        for name, parent in zip(NAMES[1:], PARENTS[1:], strict=True)
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?><mvnx xmlns="http://www.xsens.com/mvn/mvnx">'
        f'<subject label="actor" frameRate="60"><segments>{segments}</segments>'
        f"{f'<joints>{links}</joints>' if joints else ''}<frames>{''.join(rows)}</frames>"
        "</subject></mvnx>"
    )


def _row(values: np.ndarray) -> str:
    return " ".join(f"{value:.9f}" for value in values.ravel())


@pytest.mark.parametrize("joints", [True, False])
def test_segments_become_joints(motion, tmp_path, joints):
    path = tmp_path / "a.mvnx"
    path.write_text(text(motion, joints))
    found = rl.read(path)
    assert (len(found), found.skeleton.names, found.skeleton.parents) == (5, NAMES, PARENTS)
    assert found.fps == pytest.approx(60)
    assert found.translations is None
    assert np.allclose(found.positions(), motion.positions(), atol=1e-6)
    assert np.allclose(rot.angle_between(found.rotations, motion.rotations), 0, atol=1e-6)


def test_one_of_several_subjects(motion, tmp_path):
    whole = text(motion)
    start, stop = whole.index("<subject"), whole.index("</mvnx>")
    other = whole[start:stop].replace("actor", "rider").replace('frameRate="60"', 'frameRate="30"')
    path = tmp_path / "a.mvnx"
    path.write_text(whole[:stop] + other + whole[stop:])
    assert contents_of(path).characters == ("actor", "rider")
    assert rl.read(path, character="rider").fps == pytest.approx(30)
    with pytest.warns(rl.RoundelayWarning, match="'actor' is read, not 'rider'"):
        assert rl.read(path).fps == pytest.approx(60)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("</frames>", "", "expected whole XML, found mismatched tag"),
        ("<mvnx", "<!DOCTYPE a><mvnx", "without definitions"),
        ('frameRate="60"', 'frameRate="x"', "positive frameRate, found 'x'"),
        ('<segment label="L3" id="3"/>', "", "numbers in frame 0, found"),
        ("Pelvis/a", "L3/a", "a circle|below itself|hang on one"),
        ("<position>", "<position>1 ", "15 numbers in frame 0, found 16"),
        ("<position>", "<position>nan ", "numbers in frame 0, found"),
        ("<orientation>", "<orientation>x ", "expected"),
        ('type="normal"', 'type="npose"', "expected frames, found none"),
        ("subject", "object", "with a subject, found none"),
    ],
)
def test_what_is_broken_is_told(motion, tmp_path, old, new, message):
    path = tmp_path / "a.mvnx"
    changed = text(motion).replace(old, new)
    assert changed != text(motion)
    path.write_text(changed)
    with pytest.raises(rl.FormatError, match=message):
        rl.read(path)


def test_the_conformance_of_readers(motion, tmp_path):
    path = tmp_path / "a.mvnx"
    path.write_text(text(motion, frames=2))
    check_reader(MvnxReader(), [path])


def test_a_walk_of_a_suit_is_looped(tmp_path):
    """All the segments of a suit are not needed for a loop to be found."""
    walk = synth.gait("walk", repetitions=4, fps=60).motion
    names = walk.skeleton.names
    places, turns = forward_kinematics(walk.skeleton, walk.rotations, walk.root_path)
    rows = "".join(
        f'<frame type="normal"><orientation>{_row(turns[n])}</orientation>'
        f"<position>{_row(places[n])}</position></frame>"
        for n in range(len(walk))
    )
    segments = "".join(f'<segment label="{name}"/>' for name in names)
    links = "".join(
        f"<joint><connector1>{names[parent]}/a</connector1><connector2>{name}/b</connector2></joint>"
        for name, parent in zip(names[1:], walk.skeleton.parents[1:], strict=True)
    )
    path = tmp_path / "walk.mvnx"
    path.write_text(
        f'<mvnx><subject label="a" frameRate="60"><segments>{segments}</segments>'
        f"<joints>{links}</joints><frames>{rows}</frames></subject></mvnx>"
    )
    assert len(rl.find_cycles(rl.read(path))) == 1
