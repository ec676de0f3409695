"""``roundelay check`` on files and folders."""

from __future__ import annotations

import gzip
import json
import struct

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.formats import in_words, readers, suffixes_of

KNOWN = ", ".join(suffixes_of(readers))


@pytest.fixture
def folder(tmp_path):
    """Four loops of a set, of which one is out of phase, and two that end wrongly."""
    cycle = rl.find_cycles(synth.gait("walk").motion)[0]
    for name, start in (("a", 0.0), ("b", 0.01), ("c", 0.99), ("late", 0.4)):
        rl.write(cycle.sample(30, start=start), tmp_path / f"{name}.bvh")
    rl.write(cycle.sample(30, repeat_first=True), tmp_path / "good.glb")
    rl.write(cycle.sample(30, repeat_first=True), tmp_path / "doubled.bvh")
    (tmp_path / "deep").mkdir()
    rl.write(cycle.sample(30), tmp_path / "deep" / "short.glb")
    return tmp_path


def check(*words):
    return CliRunner().invoke(app, ["check", *map(str, words)])


def test_a_clean_loop_ends_with_0(folder):
    for name in ("a.bvh", "late.bvh", "good.glb"):
        shown = check(folder / name)
        assert (shown.exit_code, shown.stdout.count("\n")) == (0, 1)
        assert shown.stdout.endswith("frames at 30 fps, clean\n")


def test_faults_of_a_folder(folder):
    shown = check(folder, "--json")
    assert shown.exit_code == 1
    loops = json.loads(shown.stdout)["loops"]
    found = {one["file"]: [fault["name"] for fault in one["faults"]] for one in loops}
    assert found == {
        str(folder / "a.bvh"): [],
        str(folder / "b.bvh"): [],
        str(folder / "c.bvh"): [],
        str(folder / "deep" / "short.glb"): ["frame missing"],
        str(folder / "doubled.bvh"): ["frame too many"],
        str(folder / "good.glb"): [],
        str(folder / "late.bvh"): ["phase"],
    }
    assert [one["mended"] for one in loops] == [None] * 7


def test_a_fault_is_said_with_its_limit(folder):
    shown = check(folder / "doubled.bvh")
    assert shown.exit_code == 1
    assert "34 frames at 30 fps, 1 fault\n" in shown.stdout
    assert "  frame too many: the last frame repeats the first" in shown.stdout
    assert "(1 frames, limit 0.65)" in shown.stdout


def test_what_is_mended_lies_beside(folder):
    before = (folder / "doubled.bvh").read_bytes()
    shown = check(folder, "--mend")
    assert shown.exit_code == 1
    assert shown.stdout.count("    -> ") == 2
    made = sorted(path.name for path in folder.rglob("*_mended.*"))
    assert made == ["doubled_mended.bvh", "short_mended.glb"]
    assert (folder / "doubled.bvh").read_bytes() == before
    assert check(folder / "doubled_mended.bvh").exit_code == 0
    assert check(folder / "deep" / "short_mended.glb").exit_code == 0
    # What was mended is no loop of its own in the next round.
    assert check(folder, "--mend").stdout == shown.stdout


def test_files_are_overwritten_if_asked(folder):
    assert check(folder / "doubled.bvh", "--mend", "--overwrite").exit_code == 1
    assert check(folder / "doubled.bvh").exit_code == 0
    assert not list(folder.rglob("*_mended.*"))


def test_a_bad_file_costs_its_line_and_never_the_run(folder):
    rl.write(rl.read(folder / "a.bvh")[:5], folder / "tiny.bvh")
    (folder / "broken.bvh").write_text("none")
    (folder / "a.vmd").write_text("a motion of another program")
    shown = check(folder)
    assert shown.exit_code == 2
    assert "broken.bvh:1:1: expected" in shown.stderr
    assert shown.stderr.splitlines()[1:] == [
        f"roundelay: {folder / 'tiny.bvh'}: a loop needs at least 8 frames, found 5",
        f"roundelay: note: {folder / 'a.vmd'}: not read, there is no reader of VMD",
    ]
    assert shown.stdout.count(" frames at 30 fps, ") == 7
    told = json.loads(check(folder, "--json").stdout)
    assert told["not_read"] == [str(folder / "a.vmd")]
    (short,) = (one for one in told["loops"] if one["file"].endswith("tiny.bvh"))
    assert (short["frames"], short["faults"]) == (None, [])
    assert "found 5" in short["error"]


def test_a_file_that_is_not_read_makes_no_fault(folder):
    for path in folder.rglob("*.*"):
        if path.name not in ("a.bvh", "good.glb"):
            path.unlink()
    (folder / "a.vmd").write_text("a motion of another program")
    shown = check(folder)
    assert (shown.exit_code, shown.stderr.count("not read")) == (0, 1)


def test_packed_loops_and_standard_input(folder):
    doubled = (folder / "doubled.bvh").read_bytes()
    (folder / "deep" / "packed.bvh.gz").write_bytes(gzip.compress(doubled))
    shown = check(folder / "deep", "--mend")
    assert (shown.exit_code, shown.stdout.count(": frame too many")) == (1, 0)
    assert shown.stdout.count("frame too many: ") == 1
    assert check(folder / "deep" / "packed_mended.bvh").exit_code == 0
    assert check(folder / "deep", "--mend").stdout == shown.stdout
    shown = check(folder / "deep" / "packed.bvh.gz", "--mend", "--overwrite")
    assert shown.exit_code == 2
    assert "found one that is packed; --mend without --overwrite writes packed_" in shown.stderr
    glb = (folder / "good.glb").read_bytes()
    shown = CliRunner().invoke(app, ["check", "-", "--as", "glb"], input=glb)
    assert (shown.exit_code, shown.stdout.split(":")[0]) == (0, "-")


@pytest.mark.filterwarnings("default::roundelay.RoundelayWarning")
def test_what_else_a_file_holds_is_not_overwritten(folder):
    path = folder / "deep" / "short.glb"
    with_more(path, lambda document: document["animations"].append(document["animations"][0]))
    with_more(path, lambda document: document.update(meshes=[{"primitives": []}]))
    before = path.read_bytes()
    shown = check(folder / "deep", "--mend", "--overwrite")
    assert shown.exit_code == 2
    assert shown.stderr.splitlines()[-1] == (
        f"roundelay: {path}: expected a file of one motion alone to overwrite, found meshes, "
        "2 animations; --mend without --overwrite writes short_mended.glb instead"
    )
    assert path.read_bytes() == before
    assert check(path, "--mend").exit_code == 1
    assert check(folder / "deep" / "short_mended.glb").exit_code == 0


def with_more(path, change):
    """Change the JSON of a GLB."""
    data = path.read_bytes()
    (length,) = struct.unpack("<I", data[12:16])
    document = json.loads(data[20 : 20 + length])
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON")
    path.write_bytes(head + text + rest)


def test_a_raw_capture_is_told_and_left(folder, captures):
    path = folder / "deep" / "raw.bvh"
    path.write_bytes((captures / "01_01.bvh").read_bytes())
    before = path.read_bytes()
    shown = check(path, "--mend", "--overwrite")
    assert shown.exit_code == 1
    assert "frames at 120 fps, not recognised as a loop, " in shown.stdout
    assert shown.stdout.endswith("    no loop, left as it is\n")
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none.bvh"], "No such file"),
        (["README.md"], f"README.md: expected a file of type {KNOWN}, found 'README.md'"),
        (["{folder}/empty"], f"expected {in_words(readers)} files, found none"),
        (["{folder}", "--overwrite"], "expected --overwrite with --mend, found it alone"),
    ],
)
def test_bad_input_costs_one_line(folder, words, message):
    (folder / "empty").mkdir()
    shown = check(*(word.format(folder=folder) for word in words))
    assert shown.exit_code == 2
    assert message in shown.stderr
    assert shown.stderr.count("\n") == 1
