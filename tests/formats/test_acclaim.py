"""ASF and AMC: conventions, oddities, refusals, and the way back."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import roundelay as rl
from roundelay import FormatError, Motion, Skeleton, read, write
from roundelay.base.errors import GapsFilled
from roundelay.formats.acclaim import AcclaimLayout
from roundelay.geometry import rotations as rot


def quaternion(rotation: Rotation) -> np.ndarray:
    return rotation.as_quat(canonical=True)[..., [3, 0, 1, 2]]


def same(first: Motion, second: Motion) -> None:
    assert first.skeleton.names == second.skeleton.names
    assert first.skeleton.parents == second.skeleton.parents
    assert np.degrees(rot.angle_between(first.rotations, second.rotations)).max() < 1e-6
    np.testing.assert_allclose(first.positions(), second.positions(), atol=1e-6)
    assert first.frame_time == pytest.approx(second.frame_time, rel=1e-12)


def test_bones_are_joints_at_their_starts(acclaim):
    motion = read(acclaim())
    skeleton = motion.skeleton
    assert skeleton.names == ("root", "lhip", "lfemur", "ltibia")
    assert skeleton.parents == (-1, 0, 1, 2)
    np.testing.assert_array_equal(skeleton.offsets, [[0, 0, 0], [0, 0, 0], [2, 0, 0], [0, -7.5, 0]])
    ((joint, end),) = skeleton.end_sites
    assert joint == 3
    np.testing.assert_array_equal(end, [0, -7, 0])
    assert motion.frame_time == 1 / 120
    assert motion.name == "07_01"
    layout = skeleton.layout
    assert isinstance(layout, AcclaimLayout)
    assert dict(layout.units)["length"] == "0.45"


def test_rotations_apply_about_fixed_axes_in_the_local_frame(acclaim):
    motion = read(acclaim())
    root = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
    np.testing.assert_allclose(motion.rotations[0, 0], quaternion(root), atol=1e-12)
    axes = Rotation.from_euler("xyz", [10, 0, 20], degrees=True)
    femur = axes * Rotation.from_euler("xyz", [5, 6, 7], degrees=True) * axes.inv()
    np.testing.assert_allclose(motion.rotations[0, 2], quaternion(femur), atol=1e-12)
    axes = Rotation.from_euler("z", 20, degrees=True)
    tibia = axes * Rotation.from_euler("x", 8, degrees=True) * axes.inv()
    np.testing.assert_allclose(motion.rotations[0, 3], quaternion(tibia), atol=1e-12)
    np.testing.assert_array_equal(motion.root_path, [[1, 2, 3], [2, 3, 4]])


ASF_SAME = {
    "CRLF": [("\n", "\r\n")],
    "tabs": [("  ", "\t")],
    "keywords in capitals": [("direction", "DIRECTION"), ("rx ry rz", "RX RY RZ")],
    "exponents": [("direction 0 -1 0", "direction 0e0 -1.0E+00 .0")],
    "no limits": [("    limits (-10.0 170.0)\n", "")],
    "limits to infinity": [("(-10.0 170.0)", "(-inf inf)")],
    "unknown bone words": [("length 7\n", "length 7\n bodymass 3\n cofmass 1\n")],
    "extra section": [(":bonedata", ":skin\n  a.skin\n:bonedata")],
    "no units": [(":units\n  mass 1.0\n  length 0.45\n  angle deg\n", "")],
    "children on lines of their own": [("    root lhip\n", "    root\n    root lhip\n")],
}


@pytest.mark.parametrize("changes", ASF_SAME.values(), ids=ASF_SAME)
def test_takes_odd_skeletons(acclaim, changes):
    plain = read(acclaim())
    path = acclaim()
    asf = path.with_name("07.asf")
    text = asf.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    asf.write_bytes(text.encode())
    same(read(path), plain)


AMC_SAME = {
    "CRLF": [("\n", "\r\n")],
    "no header": [("#!OML:ASF somewhere\n:FULLY-SPECIFIED\n:DEGREES\n", "")],
    "numbers from 700": [("\n1\n", "\n700\n"), ("\n2\n", "\n701\n")],
    "numbers from 0": [("\n1\n", "\n0\n"), ("\n2\n", "\n1\n")],
    "bones in another order": [("lfemur 5 6 7\nltibia 8", "ltibia 8\nlfemur 5 6 7")],
    "bones in another order in one frame": [("lfemur 6 7 8\nltibia 9", "ltibia 9\nlfemur 6 7 8")],
    "blank lines": [("\n2\n", "\n\n2\n\n")],
    "comments": [("\n2\n", "\n# the second\n2 // frame\n")],
    "trailing blanks": [("ltibia 9\n", "ltibia 9  \n\n  \n")],
    "no last newline": [("ltibia 9\n", "ltibia 9")],
    "exponents": [("ltibia 9", "ltibia 0.9E+001")],
    "odd comment bytes": [("somewhere", "f\u00fcr")],
}


@pytest.mark.parametrize("changes", AMC_SAME.values(), ids=AMC_SAME)
def test_takes_odd_motions(acclaim, changes):
    plain = read(acclaim())
    path = acclaim()
    text = path.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_bytes(text.encode("latin-1"))
    same(read(path), plain)


def test_radians(acclaim):
    plain = read(acclaim())
    path = acclaim()
    lines = []
    for line in path.read_text().replace(":DEGREES", ":RADIANS").splitlines():
        words = line.split()
        first = 4 if words[0] == "root" else 1
        if words[0] in ("root", "lfemur", "ltibia"):
            words[first:] = [repr(np.radians(float(word)).item()) for word in words[first:]]
        lines.append(" ".join(words))
    path.write_text("\n".join(lines))
    same(read(path), plain)


def test_skeleton_in_radians(acclaim):
    plain = read(acclaim())
    ten, twenty = np.radians([10, 20]).tolist()
    path = acclaim(
        [
            ("angle deg", "angle rad"),
            ("axis 10 0 20 XYZ", f"axis {ten} 0 {twenty} XYZ"),
            ("axis 0 0 20 XYZ", f"axis 0 0 {twenty} XYZ"),
        ]
    )
    same(read(path), plain)
    write(read(path), path.with_name("b.amc"))
    same(read(path.with_name("b.amc")), plain)


def test_the_rate_of_the_file(acclaim):
    path = acclaim(amc=[(":DEGREES", ":SAMPLES-PER-SECOND 60\n:DEGREES")])
    assert read(path).frame_time == 1 / 60


def test_orders_of_axes_and_channels(acclaim):
    path = acclaim(
        [("axis 10 0 20 XYZ", "axis 10 30 20 ZXY"), ("dof rx ry rz", "dof ry rz rx")],
        [("lfemur 5 6 7", "lfemur 6 7 5")],
    )
    # Fixed axes in the order Z, X, Y take the angles as written, first to last.
    axes = Rotation.from_euler("zxy", [10, 30, 20], degrees=True)
    turn = Rotation.from_euler("yzx", [6, 7, 5], degrees=True)
    expected = quaternion(axes * turn * axes.inv())
    np.testing.assert_allclose(read(path).rotations[0, 2], expected, atol=1e-12)


def test_translations_of_a_bone(acclaim):
    path = acclaim(
        [("dof rx\n", "dof tx ty tz rx l\n")],
        [("ltibia 8", "ltibia 1 2 3 8 .5"), ("ltibia 9", "ltibia 0 0 0 9 0")],
    )
    motion = read(path)
    axes = Rotation.from_euler("z", 20, degrees=True)
    moved = axes.apply([1, 2, 3]) + np.array([0, -7.5, 0])
    np.testing.assert_allclose(motion.translations[0, 3], moved)
    np.testing.assert_allclose(motion.translations[1], motion.skeleton.offsets)
    write(motion, path.with_name("b.amc"))
    same(read(path.with_name("b.amc")), motion)


def test_a_bone_that_stretches_moves_its_children(acclaim):
    path = acclaim(
        [("dof rx ry rz", "dof rx ry rz l")],
        [("lfemur 5 6 7", "lfemur 5 6 7 2"), ("lfemur 6 7 8", "lfemur 6 7 8 0")],
    )
    motion = read(path)
    np.testing.assert_allclose(motion.translations[:, 3], [[0, -9.5, 0], [0, -7.5, 0]])


def test_the_root_at_rest(acclaim):
    path = acclaim(
        [("position 0 0 0", "position 5 6 7"), ("orientation 0 0 0", "orientation 90 0 0")]
    )
    motion = read(path)
    np.testing.assert_array_equal(motion.root_path[0], [6, 8, 10])
    axes = Rotation.from_euler("x", 90, degrees=True)
    turn = axes * Rotation.from_euler("xyz", [10, 20, 30], degrees=True) * axes.inv()
    np.testing.assert_allclose(motion.rotations[0, 0], quaternion(turn), atol=1e-12)
    write(motion, path.with_name("b.amc"))
    same(read(path.with_name("b.amc")), motion)


ASF_REFUSED = {
    "conflict mark": ([(":version", "<<<<<<< HEAD\n:version")], 2, 1, "a section like"),
    "section twice": ([(":bonedata", ":root\n:bonedata")], 15, 1, "each section once"),
    "no root": ([(":root\n", ":rooot\n")], 48, 6, "expected a section :root"),
    "no hierarchy": ([(":hierarchy", ":hierarhcy")], 48, 6, "expected a section :hierarchy"),
    "unit of angle": ([("angle deg", "angle grad")], 7, 9, "expected deg or rad, found 'grad'"),
    "root word": ([("   axis XYZ\n   pos", "   axes XYZ\n   pos")], 12, 4, "found 'axes'"),
    "root order": ([("TX TY TZ", "TX TY QZ")], 11, 16, "found 'QZ'"),
    "direction short": ([("direction 1 0 0", "direction 1 0")], 19, 18, "expected 3 values"),
    "direction nan": ([("direction 1 0 0", "direction 1 nan 0")], 19, 18, "found 'nan'"),
    "length word": ([("length 2", "length two")], 20, 13, "found 'two'"),
    "axis order": ([("axis 0 0 0 XYZ", "axis 0 0 0 XYY")], 21, 17, "order of axes like XYZ"),
    "no axis order": ([("axis 0 0 0 XYZ", "axis 0 0 0")], 21, 15, "expected 4 values"),
    "dof unknown": ([("dof rx ry rz", "dof rx ry rq")], 29, 15, "found 'rq'"),
    "dof twice": ([("dof rx ry rz", "dof rx ry rx")], 29, 15, "found 'rx'"),
    "no name": ([("     name lhip\n", "")], 21, 3, "expected name before the end"),
    "no length": ([("     length 2\n", "")], 21, 3, "expected length before the end"),
    "duplicate bone": ([("name ltibia", "name lfemur")], 36, 11, "not used before"),
    "bone called root": ([("name ltibia", "name root")], 36, 11, "not used before"),
    "bone too long": (
        [("length 7.5", "length 1e99"), ("direction 0 -1 0", "direction 0 -1e99 0")],
        26,
        18,
        "expected a number, found '-1e99', more than 1e+12",
    ),
    "no begin": ([("  begin\n     id 1", "     id 1")], 16, 6, "expected begin, found 'id'"),
    "no end": ([("  end\n:hierarchy", ":hierarchy")], 47, 6, "expected end of the bone"),
    "not in hierarchy": ([("    lfemur ltibia\n", "")], 36, 11, "in :hierarchy"),
    "unknown in hierarchy": ([("lfemur ltibia", "lfemur rtibia")], 47, 12, "a bone of :bonedata"),
    "two parents": ([("lhip lfemur", "lhip lfemur ltibia")], 47, 12, "one parent for each bone"),
    "a ring": ([("root lhip\n", "ltibia lhip\n")], 18, 11, "in :hierarchy below the root"),
    "hierarchy open": ([("ltibia\n  end", "ltibia\n")], 47, 18, "expected end of the hierarchy"),
}


@pytest.mark.parametrize(
    ("asf", "line", "column", "message"), ASF_REFUSED.values(), ids=ASF_REFUSED
)
def test_refuses_skeletons(acclaim, asf, line, column, message):
    path = acclaim(asf)
    with pytest.raises(FormatError) as caught:
        read(path)
    assert (caught.value.line, caught.value.column) == (line, column), str(caught.value)
    assert message in str(caught.value)
    assert caught.value.path == path.with_name("07.asf")


def test_what_was_not_seen_is_a_gap(acclaim):
    path = acclaim(amc=[("ltibia 9", "ltibia nan")])
    with pytest.warns(GapsFilled, match="1 values that are missing .* in frame 1, are filled"):
        found = read(path)
    joint = found.skeleton.index("ltibia")
    assert np.allclose(found.rotations[1, joint], found.rotations[0, joint])


AMC_REFUSED = {
    "missing bone": ([("lfemur 6 7 8\n", "")], 10, 9, "expected bone lfemur in the last frame"),
    "missing bone early": ([("lfemur 5 6 7\n", "")], 7, 1, "expected bone lfemur in this frame"),
    "unknown bone": ([("lfemur 6", "lhip 6")], 10, 1, "expected a bone of the skeleton"),
    "bone twice": ([("ltibia 9", "lfemur 6 7 8")], 11, 1, "each bone once in a frame"),
    "too many numbers": ([("ltibia 9", "ltibia 9 9")], 11, 10, "expected 1 numbers for ltibia"),
    "too few numbers": ([("lfemur 6 7 8", "lfemur 6 7")], 10, 10, "expected 3 numbers for lfemur"),
    "truncated": ([("lfemur 6 7 8\nltibia 9\n", "lfe")], 10, 1, "a bone of the skeleton"),
    "inf": ([("ltibia 9", "ltibia inf")], 11, 8, "expected a number, found 'inf'"),
    "infinite": ([("ltibia 9", "ltibia 1e999")], 11, 8, "found '1e999'"),
    "underscore": ([("ltibia 9", "ltibia 1_0")], 11, 8, "found '1_0'"),
    "number skipped": ([("\n2\n", "\n3\n")], 8, 1, "expected frame 2, found '3'"),
    "number repeated": ([("\n2\n", "\n1\n")], 8, 1, "expected frame 2, found '1'"),
    "number not whole": ([("\n2\n", "\n2.0\n")], 8, 1, "expected the number of a frame"),
    "no number": ([("\n2\n", "\n")], 8, 1, "each bone once in a frame, found 'root'"),
    "no first number": ([("\n1\n", "\n")], 4, 1, "expected the number of a frame, found 'root'"),
    "no frames": ([(":DEGREES\n1", ":DEGREES\n:OTHER 1\n:")], 11, 9, ""),
    "rate": ([(":DEGREES", ":SAMPLES-PER-SECOND 0")], 3, 21, "expected a positive frame rate"),
}


@pytest.mark.parametrize(
    ("amc", "line", "column", "message"), AMC_REFUSED.values(), ids=AMC_REFUSED
)
def test_refuses_motions(acclaim, amc, line, column, message):
    path = acclaim(amc=amc)
    with pytest.raises(FormatError) as caught:
        read(path)
    assert message in str(caught.value)
    assert caught.value.path == path
    if message:
        assert (caught.value.line, caught.value.column) == (line, column), str(caught.value)


def test_a_heading_alone_is_no_motion(acclaim):
    path = acclaim()
    path.write_text(":FULLY-SPECIFIED\n:DEGREES\n")
    with pytest.raises(FormatError, match="expected frames, found the end of the file"):
        read(path)


def test_refuses_bones_deeper_than_sense(acclaim):
    deep = 300
    bone = "begin\nid 1\nname b{}\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\nend\n"
    bones = "".join(bone.format(number) for number in range(deep))
    tree = "".join(f"b{number} b{number + 1}\n" for number in range(deep - 1))
    path = acclaim(
        [
            ("  end\n:hierarchy", "  end\n" + bones + ":hierarchy"),
            ("root lhip", "root lhip b0\n" + tree),
        ]
    )
    with pytest.raises(FormatError, match="at most 256 deep"):
        read(path)


def test_refuses_a_motion_much_larger_than_its_file(acclaim):
    bone = "begin\nid 1\nname b{}\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\nend\n"
    many = range(3000)
    path = acclaim(
        [
            ("  end\n:hierarchy", "  end\n" + "".join(map(bone.format, many)) + ":hierarchy"),
            ("root lhip", "root lhip " + " ".join(f"b{number}" for number in many)),
        ]
    )
    frame = "root 1 2 3 4 5 6\nlfemur 5 6 7\nltibia 8\n"
    path.write_text("".join(f"{number}\n{frame}" for number in range(100)))
    with pytest.raises(FormatError, match="channels on most of the joints"):
        read(path)


def test_a_missing_file_is_an_os_error(acclaim):
    with pytest.raises(FileNotFoundError):
        read(acclaim().with_name("none.amc"))


class TestFindingTheSkeleton:
    def test_by_name(self, acclaim, tmp_path):
        path = acclaim()
        (tmp_path / "0.asf").write_text("no skeleton")
        (tmp_path / "other.asf").write_text("no skeleton")
        assert len(read(path)) == 2

    def test_in_the_folder_above(self, acclaim, tmp_path):
        path = acclaim()
        (tmp_path / "sub").mkdir()
        moved = path.rename(tmp_path / "sub" / path.name)
        assert len(read(moved)) == 2

    def test_the_only_one(self, acclaim, tmp_path):
        path = acclaim()
        (tmp_path / "07.asf").rename(tmp_path / "player.asf")
        assert len(read(path)) == 2

    def test_given(self, acclaim, tmp_path):
        path = acclaim()
        asf = (tmp_path / "07.asf").rename(tmp_path / "elsewhere.txt")
        motion = read(path, skeleton=str(asf))
        same(read(path, skeleton=motion.skeleton), motion)

    def test_none(self, acclaim, tmp_path):
        path = acclaim()
        (tmp_path / "07.asf").unlink()
        with pytest.raises(FormatError, match="an ASF whose name begins like '07_01'") as caught:
            read(path)
        assert caught.value.path == path

    def test_one_of_another_format(self, acclaim):
        with pytest.raises(ValueError, match="read from an ASF"):
            read(acclaim(), skeleton=Skeleton(("root",), (-1,), np.zeros((1, 3))))


def test_written_files_keep_the_skeleton_and_its_words(acclaim, tmp_path):
    path = acclaim(amc=[("lfemur 5 6 7\nltibia 8", "ltibia 8\nlfemur 5 6 7")])
    text = path.read_text().replace("lfemur 6 7 8\nltibia 9", "ltibia 9\nlfemur 6 7 8")
    path.write_text(text)
    write(read(path), tmp_path / "b.amc")
    same(read(tmp_path / "b.amc"), read(path))
    words = (tmp_path / "b.asf").read_text().split()
    original = (tmp_path / "07.asf").read_text().replace("# a comment\n", "").split()
    assert sorted(words) == sorted(original)
    frames = (tmp_path / "b.amc").read_text().split("\n1\n")[1]
    assert frames.split() == text.split("\n1\n")[1].split()


def test_lengths_follow_a_scale(acclaim, tmp_path):
    motion = read(acclaim()).scaled(2.5)
    write(motion, tmp_path / "b.amc")
    same(read(tmp_path / "b.amc"), motion)
    assert "length 18.75" in (tmp_path / "b.asf").read_text()


def test_channels_are_added_where_the_motion_needs_them(acclaim, tmp_path):
    motion = read(acclaim())
    turns = motion.rotations.copy()
    turns[:, [1, 3]] = rot.from_rotation_vector([0.1, 0.2, 0.3])
    changed = replace(motion, rotations=turns, frame_time=1 / 30)
    write(changed, tmp_path / "b.amc")
    same(read(tmp_path / "b.amc"), changed)
    assert ":SAMPLES-PER-SECOND 30.0" in (tmp_path / "b.amc").read_text()


def places(motion: Motion, like: Motion) -> np.ndarray:
    names = motion.skeleton.names
    joints = [0, *(names.index(name) for name in like.skeleton.names[1:])]
    return motion.positions()[:, joints]


@pytest.mark.filterwarnings("ignore::roundelay.base.errors.RoundelayWarning")
@pytest.mark.parametrize("name", ["01_01", "Boxing_Toes"])
def test_from_bvh_to_amc_and_back(captures, tmp_path, name):
    motion = read(captures / f"{name}.bvh")[:200]
    close = 1e-4 * motion.skeleton.size
    write(motion, tmp_path / "a.amc")
    across = read(tmp_path / "a.amc")
    assert across.frame_time == pytest.approx(motion.frame_time)
    np.testing.assert_allclose(places(across, motion), motion.positions(), atol=close)
    write(across, tmp_path / "b.bvh")
    back = read(tmp_path / "b.bvh")
    np.testing.assert_allclose(places(back, motion), motion.positions(), atol=close)


def test_from_amc_to_bvh_and_back(acclaim, tmp_path):
    motion = read(acclaim())
    write(motion, tmp_path / "b.bvh")
    across = read(tmp_path / "b.bvh")
    np.testing.assert_allclose(places(across, motion), motion.positions(), atol=1e-6)
    write(across, tmp_path / "c.amc")
    np.testing.assert_allclose(
        places(read(tmp_path / "c.amc"), motion), motion.positions(), atol=1e-6
    )


def test_bone_lengths_that_change_survive(tmp_path):
    skeleton = Skeleton(("hips", "a", "b"), (-1, 0, 1), [[0, 0, 0], [1, 0, 0], [0, 2, 0]])
    turns = rot.from_rotation_vector(np.linspace(0, 1, 18).reshape(2, 3, 3))
    moved = np.tile(skeleton.offsets, (2, 1, 1))
    moved[1, 2] = 3.0
    motion = Motion(skeleton, turns, np.ones((2, 3)), 1 / 120, moved)
    write(motion, tmp_path / "a.amc")
    np.testing.assert_allclose(
        places(read(tmp_path / "a.amc"), motion), motion.positions(), atol=1e-6
    )


def test_names_cannot_break_the_file(tmp_path):
    names = ("hips", "root", "12", "a b", "a_b", "end", "x#y", "c\0d", "\x1f")
    skeleton = Skeleton(names, (-1, *range(8)), np.ones((9, 3)))
    rl.write(Motion(skeleton, rot.identity(2, 9), np.zeros((2, 3)), 0.1), tmp_path / "a.amc")
    expected = ("root", "root_", "12_", "a_b", "a_b_", "end_", "x_y", "c_d", "_")
    again = read(tmp_path / "a.amc")
    assert {*expected} < {*again.skeleton.names}
