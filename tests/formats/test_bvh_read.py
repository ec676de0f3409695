"""What a BVH reader must take, and what it must refuse, saying where."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from roundelay import FormatError, read
from roundelay.base.errors import GapsFilled, RoundelayWarning
from roundelay.geometry import rotations as rot

BODY = """1 2 3 10 20 30 1 2 3 4 5 6
2 3 4 11 21 31 2 3 4 5 6 7
3 4 5 12 22 32 3 4 5 6 7 8
"""


def same(first, second):
    assert first.skeleton.names == second.skeleton.names
    np.testing.assert_allclose(first.root_path, second.root_path)
    np.testing.assert_allclose(rot.angle_between(first.rotations, second.rotations), 0, atol=1e-9)
    assert first.frame_time == pytest.approx(second.frame_time)


def test_reads_what_is_written(bvh):
    motion = read(bvh())
    assert motion.skeleton.names == ("Hips", "Spine", "LeftLeg")
    assert motion.skeleton.parents == (-1, 0, 0)
    np.testing.assert_array_equal(motion.skeleton.offsets, [[0, 0, 0], [0, 10, 0], [2, -8, 0]])
    assert [joint for joint, _ in motion.skeleton.end_sites] == [1, 2]
    np.testing.assert_array_equal(motion.root_path, [[1, 2, 3], [2, 3, 4], [3, 4, 5]])
    assert motion.frame_time == 0.04
    assert motion.name == "a"
    expected = Rotation.from_euler("ZXY", [10, 20, 30], degrees=True).as_quat()[[3, 0, 1, 2]]
    np.testing.assert_allclose(motion.rotations[0, 0], expected)
    expected = Rotation.from_euler("XYZ", [4, 5, 6], degrees=True).as_quat()[[3, 0, 1, 2]]
    np.testing.assert_allclose(motion.rotations[0, 2], expected)


SAME = {
    "CRLF": [("\n", "\r\n")],
    "CR": [("\n", "\r")],
    "tabs": [("  ", "\t")],
    "lower case": [("HIERARCHY", "hierarchy"), ("Zrotation", "zrotation"), ("ROOT", "Root")],
    "blank lines": [("MOTION\n", "\n\nMOTION\n\n"), ("Frame Time", "\nFrame Time")],
    "trailing blanks": [("6\n", "6   \n\n \t\n"), ("ROOT Hips", "ROOT Hips  ")],
    "no last newline": [("7 8\n", "7 8")],
    "comments": [("HIERARCHY", "# made by hand {\nHIERARCHY"), ("Hips\n", "Hips // root\n")],
    "comment in body": [("2 3 4 11", "# frame 2\n2 3 4 11")],
    "braces on the line": [("Hips\n{", "Hips {"), ("Spine\n  {", "Spine{")],
    "end site": [("End Site", "End site")],
    "end site joined": [("End Site", "EndSite")],
    "end site bare": [("End Site", "END")],
    "end site named": [("End Site", "End Site LeftToe")],
    "no colon blanks": [("Frames: 3", "Frames:3"), ("Frame Time: 0.04", "Frame Time:0.04")],
    "tab after colon": [("Frames: 3", "Frames:\t3"), ("Frame Time: ", "frame time:\t")],
    "no leading zero": [("0.04", ".04")],
    "exponent": [("0.04", "4E-2"), ("1 2 3 10", "1e0 .2E+1 300e-002 +10.")],
    "one line": [("6\n2 3 4", "6 2 3 4"), ("7\n3 4 5", "7 3 4 5")],
    "several lines": [("30 1 2 3", "30\n1\n2 3"), ("7 8\n", "\n7\n8\n")],
    "channels before offset": [
        (
            "OFFSET 0 10 0\n    CHANNELS 3 Zrotation Xrotation Yrotation",
            "CHANNELS 3 Zrotation Xrotation Yrotation\n    OFFSET 0 10 0",
        )
    ],
}


@pytest.mark.parametrize("changes", SAME.values(), ids=SAME)
def test_takes_oddities(bvh, changes):
    plain = read(bvh())
    text = bvh().read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    same(read(bvh(text=text)), plain)


def test_takes_a_byte_order_mark(bvh):
    plain = read(bvh())
    same(read(bvh(text=b"\xef\xbb\xbf" + bvh().read_bytes())), plain)


def test_names_may_hold_blanks_and_any_letters(bvh):
    motion = read(bvh(("JOINT Spine", "JOINT Bip01 L Oberkörper")))
    assert motion.skeleton.names[1] == "Bip01 L Oberkörper"


def test_rotations_before_positions(bvh):
    channels = "Xposition Yposition Zposition Zrotation Xrotation Yrotation"
    turned = "Zrotation Xrotation Yrotation Xposition Yposition Zposition"
    plain = read(bvh())
    changed = [(channels, turned)]
    changed += [(f"{a} {b}", f"{b} {a}") for a, b in (("1 2 3", "10 20 30"), ("2 3 4", "11 21 31"))]
    same(read(bvh(*changed, ("3 4 5 12 22 32", "12 22 32 3 4 5"))), plain)


def test_fewer_channels(bvh):
    motion = read(
        bvh(
            ("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 1 Xrotation"),
            ("CHANNELS 3 Xrotation Yrotation Zrotation", "CHANNELS 0"),
            ("30 1 2 3 4 5 6", "30 90"),
            ("31 2 3 4 5 6 7", "31 90"),
            ("32 3 4 5 6 7 8", "32 90"),
        )
    )
    np.testing.assert_allclose(motion.rotations[:, 1], [[0.5**0.5, 0.5**0.5, 0, 0]] * 3)
    np.testing.assert_allclose(motion.rotations[:, 2], [[1, 0, 0, 0]] * 3)


def test_a_root_without_positions_stands_at_its_offset(bvh):
    motion = read(
        bvh(
            ("OFFSET 0 0 0", "OFFSET 7 8 9"),
            ("6 Xposition Yposition Zposition", "3"),
            (BODY, "10 20 30 1 2 3 4 5 6\n" * 3),
        )
    )
    np.testing.assert_array_equal(motion.root_path, [[7, 8, 9]] * 3)


def test_positions_of_a_joint_replace_its_offset(bvh):
    motion = read(
        bvh(
            ("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 2 Yposition Xrotation"),
            (BODY, "0 0 0 0 0 0 10 0 0 0 0\n" * 2 + "0 0 0 0 0 0 12 0 0 0 0\n"),
        )
    )
    np.testing.assert_array_equal(motion.translations[:, 1], [[0, 10, 0], [0, 10, 0], [0, 12, 0]])
    np.testing.assert_array_equal(motion.translations[:, 2], [[2, -8, 0]] * 3)


def test_positions_that_stay_at_the_offset_are_no_translations(bvh):
    motion = read(
        bvh(
            ("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 2 Yposition Xrotation"),
            (BODY, "0 0 0 0 0 0 10 0 0 0 0\n" * 3),
        )
    )
    assert motion.translations is None


@pytest.mark.parametrize(("unit", "away", "moves"), [(1, 1e-5, False), (1e-3, 5e-7, True)])
def test_how_far_a_joint_leaves_its_offset_is_told_in_body_sizes(bvh, unit, away, moves):
    """Half a millionth is more for a body of a fiftieth than a hundred thousandth for one of 20."""
    frame = f"0 0 0 0 0 0 {10 * unit:.10g} 0 0 0 0\n"
    motion = read(
        bvh(
            ("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 2 Yposition Xrotation"),
            *((f"OFFSET 0 {y} 0", f"OFFSET 0 {y * unit:.10g} 0") for y in (10, 5, -6)),
            ("OFFSET 2 -8 0", f"OFFSET {2 * unit:.10g} {-8 * unit:.10g} 0"),
            (BODY, frame * 2 + f"0 0 0 0 0 0 {10 * unit + away:.10g} 0 0 0 0\n"),
        )
    )
    assert (motion.translations is not None) == moves


def test_one_line_too_many_is_left_out_with_a_warning(bvh):
    with pytest.warns(RoundelayWarning, match="1 frame more than the 3 promised"):
        motion = read(bvh(text=bvh().read_text() + "4 5 6 13 23 33 4 5 6 7 8 9\n"))
    assert len(motion) == 3


REFUSED = {
    "no hierarchy": ([("HIERARCHY\n", "")], 1, 1, "expected HIERARCHY, found 'ROOT'"),
    "no root": ([("ROOT Hips\n", "")], 2, 1, "expected ROOT, found '{'"),
    "no root name": ([("ROOT Hips", "ROOT")], 3, 1, "expected a joint's name, found '{'"),
    "two roots": ([("JOINT Spine", "ROOT Spine")], 6, 3, "expected OFFSET, CHANNELS, JOINT"),
    "unknown word": ([("JOINT Spine", "BONE Spine")], 6, 3, "found 'BONE'"),
    "unknown channel": ([("Zrotation Xr", "Wrotation Xr")], 5, 44, "found 'Wrotation'"),
    "channel twice": ([("Zrotation Xr", "Yrotation Xr")], 5, 64, "expected each channel once"),
    "channel count": ([("CHANNELS 3 X", "CHANNELS 4 X")], 19, 5, "like Xposition"),
    "too few counted": ([("CHANNELS 3 X", "CHANNELS 2 X")], 18, 36, "found 'Zrotation'"),
    "count no number": ([("CHANNELS 3 X", "CHANNELS x X")], 18, 14, "from 0 to 9"),
    "huge count": ([("CHANNELS 3 X", "CHANNELS 999999999999 X")], 18, 14, "from 0 to 9"),
    "offset twice": ([("OFFSET 0 10 0", "OFFSET 0 10 0 OFFSET 1 1 1")], 8, 19, "no further OFFSET"),
    "no offset": ([("    OFFSET 0 10 0\n", "")], 13, 3, "expected OFFSET before, found '}'"),
    "no channels": (
        [("    CHANNELS 3 Xrotation Yrotation Zrotation\n", "")],
        22,
        3,
        "expected CHANNELS before",
    ),
    "offset short": ([("OFFSET 0 10 0", "OFFSET 0 10")], 9, 5, "found 'CHANNELS'"),
    "offset nan": ([("OFFSET 0 10 0", "OFFSET 0 nan 0")], 8, 14, "found 'nan'"),
    "offset hex": ([("OFFSET 0 10 0", "OFFSET 0 0x10 0")], 8, 14, "found '0x10'"),
    "offset underscore": ([("OFFSET 0 10 0", "OFFSET 0 1_0 0")], 8, 14, "found '1_0'"),
    "joint in end site": ([("OFFSET 0 5 0", "JOINT X")], 12, 7, "in an end site"),
    "brace missing": ([("  }\n}\nMOTION", "}\nMOTION")], 24, 1, "found 'MOTION'"),
    "brace too many": ([("}\nMOTION", "}\n}\nMOTION")], 25, 1, "expected MOTION, found '}'"),
    "open brace missing": ([("Spine\n  {\n", "Spine\n")], 7, 5, "expected {, found 'OFFSET'"),
    "no motion": ([("MOTION\n", "")], 25, 1, "expected MOTION, found 'Frames:'"),
    "no frames": ([("Frames: 3\n", "")], 26, 1, "expected Frames: and a whole number"),
    "frames float": ([("Frames: 3", "Frames: 3.0")], 26, 1, "whole number"),
    "frames negative": ([("Frames: 3", "Frames: -3")], 26, 1, "whole number"),
    "frames zero": ([("Frames: 3", "Frames: 0")], 26, 1, "at least one frame"),
    "frames too many": ([("Frames: 3", "Frames: 4")], 30, 27, "expected 4 frames of 12 numbers"),
    "frames huge": ([("Frames: 3", "Frames: 1000000000000")], 30, 27, "found 3 frames"),
    "frames enormous": ([("Frames: 3", "Frames: " + "9" * 5000)], 30, 27, "found 3 frames"),
    "no time": ([("Frame Time: 0.04\n", "")], 27, 1, "expected Frame Time: and a positive"),
    "time zero": ([("0.04", "0")], 27, 13, "expected a positive frame time, found '0'"),
    "time negative": ([("0.04", "-0.04")], 27, 13, "found '-0.04'"),
    "time nan": ([("0.04", "nan")], 27, 13, "found 'nan'"),
    "time infinite": ([("0.04", "1e999")], 27, 13, "found '1e999'"),
    "value inf": ([("11 21 31", "11 -inf 31")], 29, 10, "found '-inf'"),
    "value overflow": ([("11 21 31", "11 1e999 31")], 29, 10, "found '1e999'"),
    "value word": ([("11 21 31", "11 x 31")], 29, 10, "found 'x'"),
    "value comma": ([("11 21 31", "11 2,1 31")], 29, 10, "found '2,1'"),
    "value two points": ([("11 21 31", "11 2.1.3 31")], 29, 10, "found '2.1.3'"),
    "value missing": ([("11 21 31", "11 21")], 29, 24, "expected 12 numbers in a frame, found 11"),
    "value extra": ([("11 21 31", "11 21 31 0")], 29, 29, "12 numbers in a frame, found 13"),
}


@pytest.mark.parametrize(("changes", "line", "column", "message"), REFUSED.values(), ids=REFUSED)
def test_refuses(bvh, changes, line, column, message):
    path = bvh(*changes)
    with pytest.raises(FormatError) as caught:
        read(path)
    assert (caught.value.line, caught.value.column) == (line, column), str(caught.value)
    assert message in str(caught.value)
    assert str(caught.value).startswith(f"{path}:{line}:{column}: ")


BYTES = {
    "empty": (b"", 1, 1, "empty file"),
    "blank": (b" \n\n ", 1, 1, "empty file"),
    "UTF-16 of one byte too many": ("HIERARCHY".encode("utf-16") + b"x", None, None, "in UTF-16"),
    "binary": (b"HIERARCHY\nROOT\x00\x01\x02", 2, 5, "found byte 0x00"),
    "Latin-1": (b"HIERARCHY\nROOT H\xfcfte\n{\n", 2, 7, "found byte 0xfc"),
    "header only": (b"HIERARCHY\n", 1, 10, "expected ROOT, found the end of the file"),
}


@pytest.mark.parametrize(("data", "line", "column", "message"), BYTES.values(), ids=BYTES)
def test_refuses_bytes(bvh, data, line, column, message):
    with pytest.raises(FormatError) as caught:
        read(bvh(text=data))
    assert (caught.value.line, caught.value.column) == (line, column), str(caught.value)
    assert message in str(caught.value)


TWIN = [("LeftLeg", "Spine")]


def test_twin_names_are_told_apart(bvh):
    with pytest.warns(RoundelayWarning, match="one name are told apart as 'Spine_2'"):
        motion = read(bvh(*TWIN))
    assert motion.skeleton.names == ("Hips", "Spine", "Spine_2")


@pytest.mark.parametrize("count", [0, 3])
def test_channels_of_an_end_site(bvh, count):
    """Named and written, or named and not written; both are known by the count of numbers."""
    named = ("OFFSET 0 5 0", "OFFSET 0 5 0\n CHANNELS 3 Zrotation Xrotation Yrotation")
    rows = "".join(
        f"{a} {b} {c} {a + 9} {b + 18} {c + 27} {a} {b} {c} {'7 7 7' if count else ''} {d}\n"
        for a, b, c, d in ((1, 2, 3, "4 5 6"), (2, 3, 4, "5 6 7"), (3, 4, 5, "6 7 8"))
    )
    found, plain = read(bvh(named, (BODY, rows))), read(bvh())
    same(found, replace(plain, rotations=found.rotations))
    np.testing.assert_allclose(found.rotations[:, 2], plain.rotations[:, 2])


def test_scale_channels_are_left_out(bvh):
    scaled = ("CHANNELS 3 Zr", "CHANNELS 6 Xscale Yscale Zscale Zr")
    rows = BODY.replace("30 1 2 3", "30 1 1 1 1 2 3").replace("31 2 3 4", "31 1 1 1 2 3 4")
    rows = rows.replace("32 3 4 5", "32 1 1 1 3 4 5")
    with pytest.warns(RoundelayWarning, match="scale channels are left out"):
        same(read(bvh(scaled, (BODY, rows))), read(bvh()))


def test_glued_numbers_are_parted(bvh):
    glued, apart = BODY.replace("10 20 30", "10-20.5-3.0e-1"), BODY.replace("20 30", "-20.5 -0.3")
    with pytest.warns(RoundelayWarning, match="2 numbers that stand glued together are parted"):
        same(read(bvh((BODY, glued))), read(bvh((BODY, apart))))


def test_decimal_commas(bvh):
    plain = bvh(("OFFSET 0 10 0", "OFFSET 0 10.5 0"), ("10 20 30", "10.25 20 30"), ("Spine", "a,b"))
    with pytest.warns(RoundelayWarning, match="decimal commas"):
        comma = read(bvh(text=plain.read_text().replace(".", ","), name="b.bvh"))
    same(comma, read(plain))
    with pytest.raises(FormatError, match="expected a number, found '10,20'"):
        read(bvh(("10 20 30", "10,20 30.5")))


ENCODED = {"UTF-16": "脚", "GBK": "左脚", "Shift-JIS": "左足センター"}


@pytest.mark.parametrize(("encoding", "name"), ENCODED.items())
def test_other_encodings_are_told(bvh, encoding, name):
    data = bvh(("Spine", name)).read_text().encode(encoding)
    with pytest.warns(RoundelayWarning, match=f"read as {encoding}; name another"):
        assert read(bvh(text=data)).skeleton.names[1] == name


def test_an_encoding_that_is_given(bvh):
    data = bvh(("Spine", "Hüfte")).read_text().encode("latin-1")
    with pytest.raises(FormatError, match="name its encoding by --encoding"):
        read(bvh(text=data))
    assert read(bvh(text=data), encoding="latin-1").skeleton.names[1] == "Hüfte"
    for wrong in ("ascii", "no-such-encoding"):
        with pytest.raises(FormatError, match=f"expected text in {wrong}"):
            read(bvh(text=data), encoding=wrong)


TWO = """ROOT Other
{
OFFSET 1 2 3
CHANNELS 1 Xrotation
}
MOTION"""


def test_one_of_several_skeletons(bvh):
    rows = [(f" {end}\n", f" {end} 90\n") for end in (6, 7, 8)]
    text = bvh(("MOTION", TWO), *rows, name="b.bvh")
    with pytest.raises(FormatError, match="'Hips', 'Other'; choose one by --character") as caught:
        read(text)
    assert caught.value.line == 25
    same(read(text, character="Hips"), read(bvh()))
    other = read(text, character="Other")
    assert other.skeleton.names == ("Other",)
    np.testing.assert_allclose(other.rotations, [[[0.5**0.5, 0.5**0.5, 0, 0]]] * 3)
    np.testing.assert_allclose(other.root_path, [[1, 2, 3]] * 3)
    with pytest.raises(FormatError, match="among 'Hips', 'Other', found 'Third'"):
        read(text, character="Third")


@pytest.mark.parametrize("count", [1, 2])
def test_surplus_frames_are_left_out_by_one_rule(bvh, count):
    path = bvh(("Frames: 3", f"Frames: {3 - count}"), name="b.bvh")
    with pytest.warns(RoundelayWarning, match=rf"{count} frames? more than .* \(--salvage keeps"):
        assert len(read(path)) == 3 - count
    with pytest.warns(RoundelayWarning, match="promised 3 are there and read"):
        same(read(path, salvage=True), read(bvh()))


def test_a_recording_that_was_cut_off(bvh):
    cut = bvh().read_text()[:-8]
    with pytest.raises(FormatError, match="--salvage keeps the whole frames"):
        read(bvh(text=cut))
    with pytest.warns(
        RoundelayWarning, match="2 are there and read, 8 numbers at the end left out"
    ):
        found = read(bvh(text=cut), salvage=True)
    same(found, read(bvh())[:2])
    # A line in the middle that is short would put all that follows into wrong channels.
    with pytest.raises(FormatError, match="expected 12 numbers in a frame, found 11"):
        read(bvh(("21 31", "21")), salvage=True)


@pytest.mark.parametrize("nothing", ["nan", "NaN", "-nan(ind)", "-1.#IND", "1.#QNAN0"])
def test_what_was_not_seen_is_a_gap(bvh, nothing):
    path = bvh(("2 3 4 11", f"2 {nothing} 4 {nothing}"))
    with pytest.warns(GapsFilled, match="2 values that are missing .* in frame 1, are filled"):
        same(read(path), read(bvh(name="whole.bvh")))


def test_what_is_no_number_is_filled_if_asked(bvh):
    path = bvh(("2 3 4 11", "2 x 4 -"), name="b.bvh")
    with pytest.raises(FormatError, match="found 'x'; --salvage fills"):
        read(path)
    with pytest.warns(RoundelayWarning, match="2 values that are missing or no number, in frame 1"):
        same(read(path, salvage=True), read(bvh()))
    with pytest.raises(FormatError, match="expected a number in channel 2, found none"):
        read(
            bvh(("1 2 3 10", "1 x 3 10"), ("2 3 4 11", "2 x 4 11"), ("3 4 5 12", "3 x 5 12")),
            salvage=True,
        )


def test_refuses_a_skeleton_deeper_than_sense(bvh):
    depth = 100_000
    text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 0\n"
    text += "".join(f"JOINT j{i}\n{{\nOFFSET 0 0 0\nCHANNELS 0\n" for i in range(depth))
    with pytest.raises(FormatError, match="at most 256 deep"):
        read(bvh(text=text))


def test_refuses_a_motion_much_larger_than_its_file(bvh):
    joints = "".join(f"JOINT j{i}\n{{\nOFFSET 0 0 0\nCHANNELS 0\n}}\n" for i in range(3000))
    text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + joints
    text += "}\nMOTION\nFrames: 2000\nFrame Time: 0.1\n" + "1\n" * 2000
    with pytest.raises(FormatError, match="channels on most of the joints"):
        read(bvh(text=text))


def test_no_channels_at_all_is_no_motion(bvh):
    text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\nMOTION\nFrames: 1000000000000\n"
    with pytest.raises(FormatError, match="at least one frame and one channel"):
        read(bvh(text=text))


def test_every_prefix_is_refused_or_says_that_frames_are_missing(bvh):
    whole = bvh().read_bytes().rstrip()
    for stop in range(len(whole) - 1):
        with pytest.raises(FormatError):
            read(bvh(text=whole[:stop]))


def test_the_bundled_captures(captures):
    jumps = read(captures / "01_01.bvh")
    assert (len(jumps), jumps.skeleton.n_joints) == (2752, 31)
    assert jumps.fps == pytest.approx(120, rel=1e-5)
    with pytest.warns(RoundelayWarning, match="1 frame more"):
        boxing = read(captures / "Boxing_Toes.bvh")
    assert (len(boxing), boxing.skeleton.n_joints) == (3069, 21)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(read(captures / "01_03.bvh")) == 4511
