"""C3D: files of all processors, what is a point and what is not, and broken files."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from tests.formats.point_samples import DEC, INTEL, SGI, c3d, places

import roundelay as rl
from roundelay.formats.c3d import C3dReader
from roundelay.formats.c3d_writer import C3dWriter
from roundelay.formats.registry import besides_motion, contents_of
from roundelay.motion.points import Points

X = places()


@pytest.fixture
def read(tmp_path):
    def make(data, name="a.c3d"):
        (tmp_path / name).write_bytes(data)
        return rl.read_points(tmp_path / name)

    return make


@pytest.mark.parametrize("processor", [INTEL, DEC, SGI])
@pytest.mark.parametrize("whole", [True, False])
def test_all_processors_give_the_same(read, processor, whole):
    analog = np.arange(5 * 2 * 2.0).reshape(5, 2, 2)
    found = read(c3d(X, processor=processor, whole=whole, analog=analog, rate=119.88))
    assert found.names == ("LASI", "RASI", "SACR")
    assert np.array_equal(found.positions, X)
    assert (found.fps, found.units, found.missing.any()) == (119.88, "mm", False)
    assert found.layout.analog.rate == 2 * 119.88
    assert np.array_equal(found.layout.analog.values, analog.reshape(10, 2))


def test_what_is_missing(read):
    words = np.zeros((5, 3))
    words[1, 0] = -1
    words[2, 1] = 0x0205
    positions = X.copy()
    positions[3, 2] = 0.0
    found = read(c3d(positions, words=words))
    assert np.argwhere(found.missing).tolist() == [[1, 0], [3, 2]]
    assert found.residuals[2, 1] == 5 * 0.125
    assert found.residuals.sum() == 5 * 0.125


def test_residuals_that_are_fractions_stay(read):
    words = np.full((5, 3), 0.25)
    assert np.all(read(c3d(X, words=words)).residuals == 0.25)


def test_labels(read):
    """Blanks behind them go; the same label twice, or none, is told apart."""
    found = read(c3d(places(5, 4), ["RKNE", "RKNE", "", "L Ankle"], width=12))
    assert found.names == ("RKNE", "RKNE 2", "point 3", "L Ankle")


def test_labels_go_on(read):
    more = [("POINT", "LABELS", ["A", "B"]), ("POINT", "LABELS2", ["C"])]
    assert read(c3d(X, more=more)).names == ("A", "B", "C")


def test_a_file_without_parameters(read):
    data = bytearray(c3d(X))
    data[516:] = b"\0" * 508 + data[data[16] * 512 - 512 :]
    data[16] = 3
    assert read(bytes(data)).names == ("point 1", "point 2", "point 3")


def test_what_a_model_computed_is_no_point(read):
    labels = ["LASI", "LHipAngles", "LHipPower", "Spasm", "COM"]
    more = [
        ("POINT", "ANGLES", ["LHipAngles"]),
        ("POINT", "POWERS", ["LHipPower"]),
        ("POINT", "INDICES", ["Spasm"]),
        ("POINT", "MARKED", ["COM"]),
        ("POINT", "TYPE_GROUPS", ["INDICES", "INDEX", "MARKED", "MARK"]),
        ("POINT", "INDEX_UNITS", "1/s"),
        ("POINT", "MARK_UNITS", "mm"),
    ]
    with pytest.warns(rl.RoundelayWarning) as told:
        found = read(c3d(places(5, 5), labels, more=more, width=10))
    assert found.names == ("LASI", "COM")
    assert [str(one.message).split(": ", 1)[1] for one in told] == [
        "3 outputs of a model, no points, left out (LHipAngles, LHipPower, Spasm)"
    ]


def test_points_in_other_units_are_none(read):
    more = [("POINT", "UNITS", ["mm", "deg", "mm"])]
    with pytest.warns(rl.RoundelayWarning, match=r"1 outputs .*RASI"):
        assert read(c3d(X, more=more)).names == ("LASI", "SACR")


def test_trajectories_without_a_label_are_left_out(read):
    with pytest.warns(rl.RoundelayWarning, match=r"2 without a label, left out \(\*1, \*2\)"):
        found = read(c3d(places(5, 4), ["LASI", "*1", "RASI", "*2"]))
    assert found.names == ("LASI", "RASI")
    # Where nothing has a label, that is all there is.
    assert read(c3d(places(5, 2), ["*1", "*2"])).names == ("*1", "*2")


def test_axes_of_segments_are_left_out_and_origins_stay(read):
    labels = ["PELO", "PELA", "PELL", "PELP", "HEAD", "HALO"]
    with pytest.warns(rl.RoundelayWarning, match="3 axes of segments, left out"):
        assert read(c3d(places(5, 6), labels)).names == ("PELO", "HEAD", "HALO")


def test_the_subject_with_most_points_is_read(read):
    labels = [f"Anna:M{n}" for n in range(12)] + [f"Ben:M{n}" for n in range(10)] + ["*4"]
    with pytest.warns(rl.RoundelayWarning, match="2 subjects .* those of Anna read"):
        found = read(c3d(places(5, 23), labels))
    assert found.names == tuple(labels[:12])


def test_rigid_bodies_are_read_as_one(read):
    labels = ["ArmL:1", "ArmL:2", "ArmR:1"]
    with pytest.warns(rl.RoundelayWarning, match="2 subjects .* read as one"):
        assert read(c3d(X, labels)).names == tuple(labels)


def test_points_never_seen_are_left_out(read):
    positions = X.copy()
    positions[:, 1] = 0.0
    with pytest.warns(rl.RoundelayWarning, match=r"1 never seen, left out \(RASI\)"):
        assert read(c3d(positions)).names == ("LASI", "SACR")


def test_analog_channels_and_plates(read):
    analog = np.arange(5 * 4 * 2.0).reshape(5, 4, 2)
    corners = np.arange(12.0).reshape(1, 4, 3)
    matrix = np.arange(36.0).reshape(1, 6, 6)
    more = [
        ("ANALOG", "USED", 2),
        ("ANALOG", "LABELS", ["Fz", "EMG 1  "]),
        ("ANALOG", "UNITS", ["N", "V"]),
        ("ANALOG", "GEN_SCALE", 2.0),
        ("ANALOG", "SCALE", np.array([0.5, 10.0])),
        ("ANALOG", "OFFSET", np.array([1, 0])),
        ("FORCE_PLATFORM", "USED", 1),
        ("FORCE_PLATFORM", "TYPE", np.array([4])),
        ("FORCE_PLATFORM", "CORNERS", corners),
        ("FORCE_PLATFORM", "ORIGIN", np.array([[1.0, 2.0, 3.0]])),
        ("FORCE_PLATFORM", "CHANNEL", np.array([[1, 2, 9, 0, 0, 0]])),
        ("FORCE_PLATFORM", "CAL_MATRIX", matrix),
    ]
    layout = read(c3d(X, analog=analog, more=more)).layout
    assert (layout.analog.names, layout.analog.units) == (("Fz", "EMG 1"), ("N", "V"))
    assert layout.analog.rate == 400.0
    assert np.array_equal(layout.analog["Fz"], analog[..., 0].ravel() - 1.0)
    assert np.array_equal(layout.analog["EMG 1"], 20.0 * analog[..., 1].ravel())
    with pytest.raises(KeyError):
        layout.analog["Fx"]
    (plate,) = layout.plates
    assert (plate.kind, plate.channels) == (4, (0, 1))
    assert np.array_equal(plate.corners, corners[0])
    assert np.array_equal(plate.matrix, matrix[0].T)


def test_unsigned_samples(read):
    analog = np.full((5, 1, 1), -32768.0)
    more = [("ANALOG", "FORMAT", "UNSIGNED"), ("ANALOG", "OFFSET", np.array([-32768]))]
    found = read(c3d(X, whole=True, analog=analog, more=more))
    assert np.all(found.layout.analog.values == 0.0)


def test_what_the_screen_says_points_up(read):
    assert read(c3d(X, more=[("POINT", "Y_SCREEN", "+Y")])).up == 1
    assert read(c3d(X)).up is None


@pytest.mark.parametrize(
    "more",
    [
        [("TRIAL", "ACTUAL_START_FIELD", [1, 0]), ("TRIAL", "ACTUAL_END_FIELD", [4464, 1])],
        [("POINT", "LONG_FRAMES", 70000.0)],
    ],
)
def test_more_frames_than_a_header_counts(read, more):
    long = np.tile(X, (14000, 1, 1))
    assert len(read(c3d(long, more=more))) == 70000


def test_frames_beyond_those_promised_are_told(read):
    data = c3d(np.tile(X, (20, 1, 1)), header={3: 50})
    with pytest.warns(rl.RoundelayWarning, match="50 frames more than the 50 promised, left out"):
        assert len(read(data)) == 50


def test_whole_numbers_are_scaled_as_the_header_says(read):
    found = read(c3d(X, whole=True, more=[("POINT", "SCALE", 0.01)]))
    assert np.array_equal(found.positions, X)


NO_SCALE = c3d(X, more=[("POINT", "SCALE", 0.0)])
GOOD = c3d(X, analog=np.ones((5, 2, 2)))
BROKEN = {
    "empty": (b"", "found an empty file"),
    "no C3D": (b"HIERARCHY\n" * 90, "second byte is 0x50"),
    "half": (GOOD[: len(GOOD) - 100], "expected 5 frames of 64 bytes from byte 1024 on, found 3"),
    "no frame": (GOOD[:1024], "found 0, at byte 1024"),
    "header alone": (GOOD[:300], "expected a header of 512 bytes"),
    "no parameters": (GOOD[:512], "expected the parameters"),
    "more points than said": (
        c3d(X, header={0: 4}),
        "expected the 3 points of POINT:USED, found 4",
    ),
    "more frames than there are": (c3d(X, header={3: 50000}), "expected 50000 frames"),
    "frames that count back": (
        c3d(X, header={2: 9, 3: 2}, more=[("POINT", "FRAMES", 0)]),
        "expected frames, found the first 9 and the last 2",
    ),
    "analog alone": (
        c3d(np.empty((5, 0, 3)), [], analog=np.ones((5, 1, 8)), more=[("POINT", "LABELS", "")]),
        "expected points, found 8 analog channels alone",
    ),
    "another processor": (GOOD[:515] + b"\x10" + GOOD[516:], "84 .Intel., 85 .DEC. or 86 .SGI."),
    "parameters in front of the file": (b"\0" + GOOD[1:], "expected parameters in block 2"),
    "frames in the header": (GOOD[:16] + b"\0\0" + GOOD[18:], "expected frames in block 2"),
    "a parameter of no type": (c3d(X, more=[("A", "B", b"\x07\0")]), "a type of -1, 1, 2 or 4"),
    "samples that do not fit": (
        c3d(X, analog=np.ones((5, 1, 3)))[:18] + b"\2" + c3d(X, analog=np.ones((5, 1, 3)))[19:],
        "expected samples of 2 a channel and frame, found 3",
    ),
    "no scale": (NO_SCALE[:12] + b"\0" * 4 + NO_SCALE[16:], "expected a scale other than 0"),
    "no rate": (c3d(X, rate=0.0), "found 0"),
    "nothing seen": (c3d(0 * X), "found none that is seen in any frame"),
    "far": (c3d(1e13 * X), "expected places of at most 1e"),
    "outputs alone": (
        c3d(X, ["A", "B", "C"], more=[("POINT", "ANGLES", ["A", "B", "C"])]),
        "expected points, found 3 outputs of a model alone",
    ),
}


@pytest.mark.parametrize("title", BROKEN)
def test_broken_files_are_refused(read, title):
    data, told = BROKEN[title]
    with pytest.raises(rl.FormatError, match=told) as error:
        read(data)
    assert error.value.path is not None


def test_cut_anywhere_is_refused(read):
    """Half a C3D is an error, wherever it is cut."""
    for stop in range(0, len(GOOD), 37):
        with pytest.raises(rl.FormatError):
            read(GOOD[:stop])


def test_parameters_that_run_into_frames_are_told(read):
    long = [("NOTES", "TEXT", ["x" * 200] * 3)]
    data = bytearray(c3d(X, more=long))
    frames = data[(data[16] - 1) * 512 :]
    data[16] = 3
    with pytest.warns(rl.RoundelayWarning, match="run into the frames, left out"):
        found = read(bytes(data[:1024]) + bytes(frames))
    assert np.array_equal(found.positions, X)


def test_comes_back_as_it_was_written(tmp_path, read):
    words = np.zeros((5, 3))
    words[1, 0], words[2, 1] = -1, 255
    more = [
        ("ANALOG", "LABELS", ["Fz"]),
        ("ANALOG", "UNITS", ["N"]),
        ("FORCE_PLATFORM", "USED", 1),
        ("FORCE_PLATFORM", "TYPE", np.array([2])),
        ("FORCE_PLATFORM", "CORNERS", np.arange(12.0).reshape(1, 4, 3)),
        ("FORCE_PLATFORM", "ORIGIN", np.array([[1.0, 2.0, 3.0]])),
        ("FORCE_PLATFORM", "CHANNEL", np.array([[1]])),
        ("POINT", "X_SCREEN", "+X"),
        ("POINT", "Y_SCREEN", "+Z"),
    ]
    points = read(c3d(X, words=words, analog=np.ones((5, 3, 1)), more=more))
    C3dWriter().write_points(points, tmp_path / "b.c3d")
    again = C3dReader().read_points(tmp_path / "b.c3d")
    assert (again.names, again.fps, again.units, again.up) == (points.names, 100.0, "mm", 2)
    assert np.array_equal(again.positions, points.positions)
    assert np.array_equal(again.missing, points.missing)
    assert np.allclose(again.residuals, points.residuals, rtol=1e-6)
    assert again.layout.analog.names == ("Fz",)
    assert np.array_equal(again.layout.analog.values, points.layout.analog.values)
    assert np.array_equal(again.layout.plates[0].corners, points.layout.plates[0].corners)


def test_analog_channels_of_another_length_are_left_out(tmp_path, read):
    points = read(c3d(X, analog=np.ones((5, 3, 1))))[1:]
    with pytest.warns(rl.RoundelayWarning, match="analog channels last longer"):
        C3dWriter().write_points(points, tmp_path / "b.c3d")
    assert C3dReader().read_points(tmp_path / "b.c3d").layout.analog is None


def test_many_points_with_long_names(tmp_path):
    names = [f"a marker with quite a long name, number {n}" for n in range(400)]
    points = Points(names, places(2, 400), 100.0)
    C3dWriter().write_points(points, tmp_path / "b.c3d")
    assert C3dReader().read_points(tmp_path / "b.c3d").names == tuple(names)
    names = [f"{n:0250d}" for n in range(600)]
    with pytest.raises(ValueError, match="expected names that take at most"):
        C3dWriter().write_points(Points(names, places(2, 600), 100.0), tmp_path / "c.c3d")
    assert not (tmp_path / "c.c3d").exists()


def test_a_long_take_comes_back(tmp_path):
    points = Points(("A", "B", "C"), np.tile(X, (14000, 1, 1)), 100.0)
    C3dWriter().write_points(points, tmp_path / "b.c3d")
    assert len(C3dReader().read_points(tmp_path / "b.c3d")) == 70000


def test_points_at_the_origin_are_seen_again(tmp_path):
    points = Points(("A", "B", "C"), np.zeros((2, 3, 3)), 100.0)
    C3dWriter().write_points(points, tmp_path / "b.c3d")
    again = C3dReader().read_points(tmp_path / "b.c3d")
    assert not again.missing.any()
    assert np.abs(again.positions).max() < 1e-30


def test_what_a_loop_in_its_place_would_lose(tmp_path):
    (tmp_path / "a.c3d").write_bytes(c3d(X, analog=np.ones((5, 3, 1))))
    assert besides_motion(tmp_path / "a.c3d") == ("analog channels",)
    (tmp_path / "b.c3d").write_bytes(c3d(X))
    assert besides_motion(tmp_path / "b.c3d") == ()


def test_as_a_motion(tmp_path):
    t = np.arange(60) / 60.0
    body = places(1, 6)[0] + np.stack([t * 50, np.sin(6 * t), np.cos(6 * t)], axis=1)[:, None]
    (tmp_path / "a.c3d").write_bytes(c3d(body, [f"M{n}" for n in range(6)]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        motion = rl.read(tmp_path / "a.c3d")
    rl.write(motion, tmp_path / "b.c3d")
    again = rl.read_points(tmp_path / "b.c3d")
    assert np.allclose(again.positions, body, atol=1e-3)


def two_people(**others):
    labels = [f"Anna:M{n}" for n in range(12)] + [f"Ben:M{n}" for n in range(10)]
    return c3d(places(5, 22), labels, **others)


def test_another_subject_can_be_chosen(tmp_path):
    path = tmp_path / "a.c3d"
    path.write_bytes(two_people())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = rl.read_points(path, character="Ben")
    assert found.names == tuple(f"Ben:M{n}" for n in range(10))
    with pytest.raises(rl.FormatError, match="among 'Anna', 'Ben', found 'Eve'"):
        rl.read_points(path, character="Eve")
    held = contents_of(path)
    assert (held.characters, held.conventions) == (("Anna", "Ben"), {"unit": "mm"})


def test_what_is_whole_of_half_a_file_can_be_kept(tmp_path):
    path = tmp_path / "a.c3d"
    path.write_bytes(GOOD[:-100])
    with pytest.warns(rl.RoundelayWarning, match="3 of 5 frames, cut off, kept"):
        assert len(rl.read_points(path, salvage=True)) == 3
    path.write_bytes(GOOD[:1030])
    with pytest.raises(rl.FormatError, match="found 0"):
        rl.read_points(path, salvage=True)


def test_residuals_too_small_for_single_precision(tmp_path):
    points = Points(("A", "B", "C"), X, 100.0, residuals=np.full((5, 3), 1e-44))
    C3dWriter().write_points(points, tmp_path / "b.c3d")
    assert C3dReader().read_points(tmp_path / "b.c3d").residuals is None
