"""Text and array files of points: TRC, STO, TSV, CSV, NPZ and NPY, sound and broken."""

from __future__ import annotations

import contextlib
import gzip
import io
import warnings
import zipfile

import numpy as np
import pytest
from tests.formats import point_samples as samples
from tests.formats.point_samples import places

import roundelay as rl
from roundelay.formats import is_capture, readers, writers
from roundelay.formats.registry import PointsReader, contents_of
from roundelay.motion.points import Points

TEXTS = {
    "a.trc": samples.TRC,
    "a.sto": samples.STO,
    "vec3.sto": samples.VEC3,
    "a.tsv": samples.QUALISYS,
    "motive.csv": samples.MOTIVE,
    "deeplabcut.csv": samples.DEEPLABCUT,
    "a.csv": samples.CSV,
}


@pytest.fixture
def read(tmp_path):
    def make(data, name):
        data = data if isinstance(data, bytes) else data.encode()
        (tmp_path / name).write_bytes(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rl.RoundelayWarning)
            return rl.read_points(tmp_path / name)

    return make


def told(points):
    return points.names, points.fps, points.units, np.argwhere(points.missing).tolist()


def test_trc(read):
    found = read(samples.TRC, "a.trc")
    assert told(found) == (("R.ASIS", "L.ASIS"), 100.0, "mm", [[1, 0]])
    assert found.positions[0].tolist() == [[1.5, 2.5, 3.5], [4.5, 5.5, 6.5]]


def test_trc_with_markers_without_names(read):
    lines = samples.TRC.replace("\t2\tmm", "\t3\tmm").splitlines(keepends=True)
    lines[6:] = [line.rstrip("\n") + "\t7\t8\t9\n" for line in lines[6:]]
    assert read("".join(lines), "a.trc").names == ("R.ASIS", "L.ASIS")


def test_trc_with_a_frame_left_out(read):
    text = samples.TRC.replace("3\t0.020", "4\t0.030")
    found = read(text, "a.trc")
    assert (len(found), np.argwhere(found.missing).tolist()) == (4, [[1, 0], [2, 0], [2, 1]])


def test_sto(read):
    found = read(samples.STO, "a.sto")
    assert told(found) == (("a", "b"), 100.0, "m", [[1, 0]])
    found = read(samples.VEC3, "b.mot")
    assert found.positions[1].tolist() == [[1.5, 2, 3], [4, 5, 6]]


def test_sto_of_bodies(tmp_path):
    text = samples.STO.replace("b_t", "a_O").replace("a_t", "a_")
    (tmp_path / "a.sto").write_text(text)
    with pytest.warns(rl.RoundelayWarning, match="3 orientations, left out"):
        assert rl.read_points(tmp_path / "a.sto").names == ("a",)


@pytest.mark.parametrize(
    ("columns", "what"),
    [
        ("pelvis_tx\tpelvis_ty\tpelvis_tz\tpelvis_tilt\thip_r\tknee_r", "coordinates of a model"),
        ("ground_force_vx\tground_force_vy\tground_force_vz\tg_px\tg_py\tg_pz", "forces"),
        ("a\tb\tc\td\te\tf", r"coordinates of a model \(a, b, c, d, ...\)"),
    ],
)
def test_sto_of_something_else_says_what_it_is(read, columns, what):
    text = samples.STO.replace("a_tx\ta_ty\ta_tz\tb_tx\tb_ty\tb_tz", columns)
    with pytest.raises(rl.FormatError, match=f"expected points, found {what}"):
        read(text, "a.mot")


def test_qualisys(read):
    found = read(samples.QUALISYS, "a.tsv")
    assert told(found) == (("L_IAS", "R_IAS"), 200.0, "mm", [[1, 0]])


def test_qualisys_with_frames_and_times(read):
    text = samples.QUALISYS.replace("\n1.5\t", "\nFrame\tTime\n1\t0.000\t1.5\t")
    text = text.replace("\n0.000\t", "\n2\t0.005\t0.000\t").replace("\n1.7\t", "\n3\t0.010\t1.7\t")
    assert np.array_equal(read(text, "a.tsv").positions, read(samples.QUALISYS, "b.tsv").positions)


def test_qualisys_of_bodies_says_so(read):
    text = samples.QUALISYS.replace("DATA_INCLUDED\t3D", "DATA_INCLUDED\t6D")
    with pytest.raises(rl.FormatError, match=r"expected markers \(3D\), found '6D'"):
        read(text, "a.tsv")


def test_motive(read):
    found = read(samples.MOTIVE, "a.csv")
    assert told(found) == (("A:Hip1",), 60.0, "m", [[1, 0]])


def test_motive_with_bones_alone(read):
    text = samples.MOTIVE.replace("Marker", "Other")
    assert told(read(text, "a.csv")) == (("A:Hip",), 60.0, "m", [])


def test_deeplabcut(read):
    found = read(samples.DEEPLABCUT, "a.csv")
    assert told(found) == (("nose", "tail"), 30.0, "px", [[1, 1]])
    assert (found.dimensions, found.image) == (2, True)
    assert found.likelihoods[:, 0].tolist() == [0.9, 0.9, 0.1]


def test_deeplabcut_of_several(read):
    lines = samples.DEEPLABCUT.splitlines(keepends=True)
    lines.insert(1, "individuals,one,one,one,two,two,two\n")
    assert read("".join(lines), "a.csv").names == ("one:nose",)


def test_the_rate_of_keypoints_is_assumed_and_told(tmp_path):
    (tmp_path / "a.csv").write_text(samples.DEEPLABCUT)
    with pytest.warns(rl.RoundelayWarning, match="30 a second assumed"):
        rl.read_points(tmp_path / "a.csv")


def test_a_plain_csv(read):
    assert told(read(samples.CSV, "a.csv")) == (("a", "b"), 50.0, "", [[1, 0]])
    flat = "a_x;a_y\n1;2\n3;4\n"
    found = read("# fps: 25, units: px, image: yes\n" + flat, "b.csv")
    assert (found.fps, found.units, found.image, found.dimensions) == (25.0, "px", True, 2)


@pytest.mark.parametrize("suffix", [".c3d", ".trc", ".sto", ".mot", ".tsv", ".csv", ".npz"])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_comes_back_as_it_was_written(tmp_path, suffix, dimensions):
    positions = 1.23456789 * places(40, 5)[..., :dimensions]
    positions[3:9, 1] = np.nan
    points = Points(
        ("LASI", "R Knee", "a:b", "c,d", "é"),
        positions,
        119.88,
        units="mm",
        residuals=np.abs(places(40, 5)[..., 0]),
        likelihoods=np.linspace(0.0, 1.0, 200).reshape(40, 5),
        image=dimensions == 2 and suffix in (".csv", ".npz"),
        links=((0, 1), (2, 4)),
    )
    writer = next(one for one in writers if suffix in one.suffixes)
    writer.write_points(points, tmp_path / f"a{suffix}")
    again = rl.read_points(tmp_path / f"a{suffix}")
    names = tuple(name.replace(",", " ") if suffix == ".csv" else name for name in points.names)
    assert (again.names, again.units, again.image) == (names, "mm", points.image)
    assert again.fps == pytest.approx(119.88, rel=1e-9)
    assert np.array_equal(again.missing, points.missing)
    assert np.allclose(again.positions[..., :dimensions], points.positions, rtol=1e-7, atol=1e-8)
    if suffix in (".csv", ".npz"):
        seen = points.seen
        assert np.allclose(again.residuals[seen], points.residuals[seen])
        assert np.allclose(again.likelihoods[seen], points.likelihoods[seen])
    assert again.links == (points.links if suffix == ".npz" else ())


@pytest.mark.parametrize("name", TEXTS)
def test_cut_within_a_row_is_refused(read, name):
    """What is cut between rows is noticed where the file says how many there are."""
    text = TEXTS[name]
    last = text.rstrip("\n").rfind("\n") + 1
    with pytest.raises(rl.FormatError):
        read(text[: last + 3], name)
    if name not in ("vec3.sto", "deeplabcut.csv", "a.csv"):
        with pytest.raises(rl.FormatError):
            read(text[:last], name)


@pytest.mark.parametrize("name", TEXTS)
def test_cut_anywhere_ends_in_a_refusal_or_in_fewer_rows(read, name):
    for stop in range(len(TEXTS[name])):
        with contextlib.suppress(rl.FormatError):
            assert len(read(TEXTS[name][:stop], name)) <= 3


@pytest.mark.parametrize("name", ["a.c3d", "a.h5", "a.npz", "a.npy", *TEXTS])
@pytest.mark.parametrize("data", [b"", b"\x00\xff\x12" * 50, b"HIERARCHY\nROOT a\n", b"\n\n"])
def test_something_else_of_that_suffix_is_refused(read, name, data):
    with pytest.raises(rl.FormatError):
        read(data, name)


BROKEN = {
    "trc: frames that are not there": ("a.trc", "\t3\t2\tmm", "\t4\t2\tmm", "expected 4 frames"),
    "trc: huge count": ("a.trc", "\t3\t2\tmm", "\t99999999999\t2\tmm", "whole number"),
    "trc: fewer names": ("a.trc", "\tL.ASIS\t\t\n", "\n", "expected names of 2 markers"),
    "trc: a decimal comma": ("a.trc", "4.7", "4,7", "found '4,7'; write decimal points"),
    "trc: another first word": ("a.trc", "PathFileType", "Path", "expected PathFileType"),
    "sto: rows that are not there": ("a.sto", "nRows=3", "nRows=4", "expected 4 rows"),
    "sto: no end of the heading": ("a.sto", "endheader", "", "expected endheader"),
    "sto: no time": ("a.sto", "time\t", "Zeit\t", "time first"),
    "tsv: frames that are not there": ("a.tsv", "FRAMES\t3", "FRAMES\t9", "NO_OF_FRAMES '9'"),
    "tsv: markers without names": ("a.tsv", "MARKERS\t2", "MARKERS\t3", "NO_OF_MARKERS '3'"),
    "tsv: no markers": ("a.tsv", "MARKER_NAMES", "NAMES", "expected MARKER_NAMES, found none"),
    "motive: frames": ("motive.csv", "Frames,3", "Frames,7", "expected 7 frames, found 3"),
    "motive: no frames": ("motive.csv", "\nFrame,", "\nNo,", "begins with Frame"),
    "motive: turns alone": ("motive.csv", "Position", "Rotation", "expected positions of markers"),
    "deeplabcut: no coords": ("deeplabcut.csv", "coords", "no", "bodyparts or coords"),
    "deeplabcut: twice": ("deeplabcut.csv", ",tail,tail,tail", ",nose,nose,nose", "found it twice"),
    "deeplabcut: pictures": ("deeplabcut.csv", "\n0,", "\nimg0.png,", "found 'img0.png'"),
    "csv: a column of something": ("a.csv", "a_x", "speed", "found 'speed'"),
    "csv: an axis less": ("a.csv", "b_z", "c_z", "expected columns x, y, z"),
    "csv: twice": ("a.csv", "b_x", "a_x", "found 'a_x' twice"),
    "csv: frames back": ("a.csv", "\n2,", "\n0,", "frame numbers that grow"),
    "csv: decimal commas": ("a.csv", "1.5", "1,5", "expected 8 fields, found 9"),
}


@pytest.mark.parametrize("title", BROKEN)
def test_broken_files_are_refused(read, title):
    name, old, new, message = BROKEN[title]
    assert old in TEXTS[name]
    with pytest.raises(rl.FormatError, match=message):
        read(TEXTS[name].replace(old, new), name)


def npz(**arrays):
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


X = places(5, 2)
BROKEN_ARRAYS = {
    "no positions": (npz(x=X), "an array 'positions', found none"),
    "objects": (npz(positions=np.array([[[None] * 3]])), "'positions' of numbers, found object"),
    "text": (npz(positions=np.array([[["a"] * 3]])), "'positions' of numbers"),
    "flat": (npz(positions=X[0]), r"shape \(F, J, 2 or 3\)"),
    "names": (npz(positions=X, names=["a"]), r"'names' of shape \(2,\)"),
    "missing": (npz(positions=X, missing=np.ones((5, 3), bool)), r"'missing' of shape \(5, 2\)"),
    "links": (npz(positions=X, links=[[0, 7]]), "'links' between points 0 to 1"),
    "rate": (npz(positions=X, fps=-1.0), "frames a second, found -1"),
    "none": (npz(positions=X[:0]), "expected at least one frame, found none"),
    "half": (npz(positions=X)[:200], "expected a whole NPZ"),
}


@pytest.mark.parametrize("title", BROKEN_ARRAYS)
def test_broken_arrays_are_refused(read, title):
    data, message = BROKEN_ARRAYS[title]
    with pytest.raises(rl.FormatError, match=message):
        read(data, "a.npz")


def test_sizes_that_promise_too_much(read):
    file = io.BytesIO()
    np.save(file, X)
    data = file.getvalue().replace(b"(5, 2, 3)", b"(5000000000, 2, 3)")
    with pytest.raises(rl.FormatError, match=r"a\.npy: expected"):
        read(data, "a.npy")
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("positions.npy", file.getvalue().replace(b"(5, 2, 3)", b"(9, 9, 3)"))
    with pytest.raises(rl.FormatError, match=r"expected 1944 bytes of 'positions' .*, found 240"):
        read(packed.getvalue(), "a.npz")


def test_an_npy_has_neither_names_nor_rate(tmp_path):
    np.save(tmp_path / "a.npy", X)
    with pytest.warns(rl.RoundelayWarning, match="tells no frame rate"):
        found = rl.read_points(tmp_path / "a.npy")
    assert (found.names, found.fps) == (("point 1", "point 2"), 30.0)
    assert np.array_equal(found.positions, X)


def test_what_of_a_folder_is_a_capture(tmp_path):
    """Tables and arrays of other things are none, though a reader knows their suffix."""
    texts = {name: text.encode() for name, text in TEXTS.items()}
    others = {"b.csv": b"start,end,label\n0,1,walk\n", "c.csv": b"", "d.tsv": b"a\tb\n1\t2\n"}
    arrays = {"e.npz": npz(positions=X), "f.npz": npz(x=X), "g.npz": b"", "i.npy": b"\x93NUMPY"}
    for name, data in (texts | others | arrays | {"j.xyz": b""}).items():
        (tmp_path / name).write_bytes(data)
    np.save(tmp_path / "k.npy", X)
    np.save(tmp_path / "l.npy", X[0])
    found = {path.name for path in tmp_path.iterdir() if is_capture(path)}
    assert found == {*texts, "e.npz", "k.npy"}


def test_packed_files(tmp_path):
    (tmp_path / "a.csv.gz").write_bytes(gzip.compress(samples.CSV.encode()))
    assert is_capture(tmp_path / "a.csv.gz")
    assert rl.read_points(tmp_path / "a.csv.gz").name == "a"


def test_every_reader_of_points_is_registered():
    known = {suffix for one in readers if isinstance(one, PointsReader) for suffix in one.suffixes}
    assert known >= {".c3d", ".trc", ".sto", ".mot", ".tsv", ".csv", ".npz", ".npy", ".h5", ".slp"}


@pytest.mark.parametrize(
    ("name", "way"), [("a.mp4", "find keypoints in the video"), ("a.tak", "export it from Motive")]
)
def test_a_refusal_names_the_way(name, way):
    with pytest.raises(rl.FormatError, match=way):
        rl.read(name)


def test_joints_of_a_motion_as_points(tmp_path, bvh):
    motion = rl.read(bvh())
    rl.write(motion, tmp_path / "a.trc")
    again = rl.read_points(tmp_path / "a.trc")
    assert again.names == motion.skeleton.names
    assert np.allclose(again.positions, motion.positions(), atol=1e-6)


def test_another_animal_or_skeleton_can_be_chosen(tmp_path):
    lines = samples.DEEPLABCUT.splitlines(keepends=True)
    lines.insert(1, "individuals,one,one,one,two,two,two\n")
    (tmp_path / "a.csv").write_text("".join(lines))
    (tmp_path / "b.csv").write_text(samples.MOTIVE.replace("Unlabeled 7", "B:Hip1"))
    (tmp_path / "c.csv").write_text("A:a_x,A:a_y,B:b_x,B:b_y\n1,2,3,4\n")
    for name, subjects, wanted, points in (
        ("a.csv", ("one", "two"), "two", ("two:tail",)),
        ("b.csv", ("A", "B"), "B", ("B:Hip1",)),
        ("c.csv", ("A", "B"), "B", ("B:b",)),
    ):
        assert contents_of(tmp_path / name).characters == subjects
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rl.RoundelayWarning)
            assert rl.read_points(tmp_path / name, character=wanted).names == points


def test_a_format_without_such_a_choice_says_so(tmp_path):
    (tmp_path / "a.trc").write_text(samples.TRC)
    with pytest.raises(ValueError, match="expected no --character"):
        rl.read_points(tmp_path / "a.trc", character="A")
    with pytest.raises(ValueError, match="expected no --salvage"):
        rl.read_points(tmp_path / "a.trc", salvage=True)


def test_points_are_written_by_the_suffix(tmp_path):
    positions = np.cumsum(np.random.default_rng(0).normal(size=(60, 1, 3)), axis=0) + places(1, 8)
    positions[4:8, 2] = np.nan
    points = Points.from_array(positions, fps=60.0)
    rl.write(points, tmp_path / "a.trc")
    assert np.array_equal(rl.read_points(tmp_path / "a.trc").missing, points.missing)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        rl.write(points, tmp_path / "a.glb")
    assert len(rl.read(tmp_path / "a.glb")) == 60
    with pytest.raises(ValueError, match="frames a second, found 1e"):
        rl.write(Points.from_array(positions, fps=1e6), tmp_path / "b.trc")
    with pytest.raises(ValueError, match="expected places of at most 1e"):
        rl.write(Points.from_array(1e14 * positions, fps=60.0), tmp_path / "b.trc")
    with pytest.raises(rl.TooShort):
        rl.write(points[:0], tmp_path / "b.trc")
    assert not (tmp_path / "b.trc").exists()
