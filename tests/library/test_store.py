"""What a library keeps: nothing wrong is read, nothing of the user's is lost."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import pytest
from tests.library.conftest import write_gait

import roundelay as rl
from roundelay.base.files import fitting, is_part, written_beside
from roundelay.base.locks import locked
from roundelay.library.log import Log
from roundelay.library.sealed import checksum, sealed, unsealed

FILES = (
    *("clips.jsonl", "library.json", "cycles.csv", "signatures/shelves.json", "library.duckdb"),
    *("tables/cycles.parquet", "tables/runs.parquet", "loops/a.bvh/a_loop.bvh"),
)
DATED = ("library.json", "clips.jsonl", "library.duckdb", "runs.parquet")


def told_of(library: rl.Library) -> dict:
    """All that a library tells, but for when it was written, which checksums depend on."""
    dated = ("written", "checksums")
    return {name: value for name, value in library.record.items() if name not in dated}


def contents(folder: Path) -> dict[str, bytes]:
    """What all files hold that do not tell the time."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in DATED
    }


def built(source: Path, folder: Path, **options) -> rl.Library:
    """Make or mend a library, in this process, with whatever it says of mending."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        return rl.build_library(source, folder, jobs=1, **options)


@pytest.fixture(scope="module")
def source(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("source")
    write_gait(folder / "a.bvh", "walk", seed=1)
    return folder


@pytest.fixture(scope="module")
def library(source, tmp_path_factory) -> rl.Library:
    """A library of one clip, to be copied."""
    return built(source, tmp_path_factory.mktemp("kept"))


@pytest.fixture
def copy(library, tmp_path) -> Path:
    return Path(shutil.copytree(library.folder, tmp_path / "copy"))


def corrupt(path: Path, seed: int) -> None:
    chance = random.Random(seed)
    data = bytearray(path.read_bytes())
    at = chance.randrange(len(data))
    if seed % 3 == 0:
        del data[at:]
    elif seed % 3 == 1:
        data[at] ^= 1 << chance.randrange(8)
    else:
        data[at : at + 40] = bytes(chance.randrange(256) for _ in range(chance.randrange(60)))
    path.write_bytes(bytes(data))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", FILES)
def test_what_is_damaged_is_mended_or_refused(library, source, copy, name, seed):
    corrupt(copy / name, seed)
    if name in ("library.json", "signatures/shelves.json"):
        with pytest.raises(rl.FormatError, match=f"a damaged {name}; run roundelay library again"):
            rl.Library.open(copy)
    else:
        assert told_of(rl.Library.open(copy)) == told_of(library)
    with pytest.warns(rl.RoundelayWarning, match="copy: mended: ") as told:
        again = rl.build_library(source, copy, jobs=1)
    assert len([one for one in told if "mended" in str(one.message)]) == 1
    assert told_of(again) == told_of(library)
    found = contents(copy)
    assert found.pop(f"{name}.changed", None) is None or "loops" in name
    assert found == contents(library.folder)
    assert not Log(copy).damaged


def test_an_intact_library_is_left_alone(library, source, copy):
    before = {path: path.stat().st_mtime_ns for path in copy.rglob("*")}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rl.build_library(source, copy, jobs=1)
    changed = [path for path, time in before.items() if path.stat().st_mtime_ns != time]
    assert changed in ([], [copy])


def test_a_loop_that_was_changed_is_put_aside(library, source, copy):
    loop = copy / "loops/a.bvh/a_loop.bvh"
    loop.write_text("mine")
    built(source, copy)
    assert loop.with_name("a_loop.bvh.changed").read_text() == "mine"
    assert loop.read_bytes() == (library.folder / "loops/a.bvh/a_loop.bvh").read_bytes()


def test_files_of_the_user_stay(source, copy):
    folder = copy / "loops" / "a.bvh"
    for name in ("my_loop_notes.txt", "a_loop9.bvh", "a_loop.txt"):
        (folder / name).write_text("mine")
    built(source, copy, again=True)
    built(source, copy, options=rl.LoopOptions(file_format="glb"))
    left = {path.name for path in folder.iterdir()}
    assert left == {"my_loop_notes.txt", "a_loop9.bvh", "a_loop.txt", "a_loop.glb"}


def test_a_file_in_the_way_is_named(source, tmp_path):
    own = tmp_path / "loops" / "a.bvh" / "a_loop.bvh"
    own.parent.mkdir(parents=True)
    own.write_text("mine")
    refused: list[str] = []
    built(source, tmp_path, refused=refused.append)
    assert own.read_text() == "mine"
    assert "move it away" in refused[0]
    own.unlink()
    assert built(source, tmp_path).summary["loops"] == 1


@pytest.mark.parametrize(
    "name",
    ["library.json", "cycles.csv", "clips.jsonl", "library.duckdb"],
)
def test_a_folder_of_something_else_is_refused(source, tmp_path, name):
    (tmp_path / name).write_text("mine")
    with pytest.raises((FileExistsError, rl.FormatError), match="expected a library"):
        built(source, tmp_path)
    assert (tmp_path / name).read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_library_of_a_later_version_is_refused(source, copy):
    (copy / "clips.jsonl").write_bytes(of_format(9, sealed({"claim": ["b.bvh", [], []]})) + b"\n")
    with pytest.raises(rl.FormatError, match="expected a library of format 4, found 9"):
        built(source, copy)


def of_format(number: int, line: bytes) -> bytes:
    """Return a sealed record as if it were of another format."""
    rest = line[21:].replace(b'"format": 4', f'"format": {number}'.encode())
    return b'{"crc32": "' + checksum(rest).encode() + b'",' + rest


def test_a_library_of_an_older_version_is_made_anew(library, source, copy):
    log, record = copy / "clips.jsonl", copy / "library.json"
    lines = log.read_bytes().splitlines()
    log.write_bytes(b"\n".join(of_format(2, line) for line in lines if b'"run"' not in line))
    record.write_bytes(of_format(2, record.read_bytes()))
    mine = copy / "loops/a.bvh/a_loop2.bvh"
    mine.write_text("mine")
    with pytest.raises(rl.FormatError, match="format 2, not 4; run roundelay library again"):
        rl.Library.open(copy)
    with pytest.warns(rl.RoundelayWarning, match="made anew, of an older format"):
        again = rl.build_library(source, copy, jobs=1)
    assert told_of(again) == told_of(library)
    assert mine.read_text() == "mine"
    mine.unlink()
    assert contents(copy) == contents(library.folder)
    assert not Log(copy).older


def test_a_crash_between_claim_and_entry(library, source, copy):
    """The loops of a clip that was being done are the library's; other files are not."""
    log = copy / "clips.jsonl"
    claim = log.read_bytes().splitlines()[0]
    log.write_bytes(claim + b"\n")
    (copy / "library.json").unlink()
    (copy / ".0123456789abcdef.part.npz").write_text("half")
    (copy / "loops/a.bvh/.0123456789abcdef.part.bvh").write_text("half")
    (copy / "loops/a.bvh/a_loop2.bvh").write_text("of the crashed run")
    again = built(source, copy)
    assert told_of(again) == told_of(library)
    assert contents(copy) == contents(library.folder)


def test_a_seal_tells_every_change():
    line = sealed({"a": "ä", "b": [1.5, None]})
    told = {"crc32": line[11:19].decode(), "format": 4}
    assert unsealed(line) == told | {"a": "ä", "b": [1.5, None]}
    for at in range(len(line)):
        assert unsealed(line[:at]) is None
        assert unsealed(line[:at] + bytes([line[at] ^ 32]) + line[at + 1 :]) is None


def test_two_runs_exclude_each_other(source, tmp_path):
    folder = tmp_path / "library"
    folder.mkdir()
    with locked(folder / "library.lock"):
        told = f"found another run \\(process {os.getpid()} on .*\\) at work on it"
        with pytest.raises(rl.Locked, match=told):
            built(source, folder)
        assert [path.name for path in folder.iterdir()] == ["library.lock"]
    assert list(folder.iterdir()) == []
    (folder / "library.lock").write_text(json.dumps({"pid": 1, "host": "gone"}))
    assert built(source, folder).summary["loops"] == 1
    assert not (folder / "library.lock").exists()


def test_names_of_any_length(tmp_path):
    long = tmp_path / "source" / ("n" * 250 + ".bvh")
    other = long.with_name("n" * 249 + "m.bvh")
    deep = tmp_path / "source" / "/".join(["folder" * 5] * 6) / "a.bvh"
    for number, path in enumerate((long, other, deep)):
        write_gait(path, "walk", seed=1 + number)
    library = built(tmp_path / "source", tmp_path / "library")
    loops = [cycle["loop"] for _, cycle in library.cycles]
    assert len(set(loops)) == len(library.clips) == 3
    assert max(map(len, loops)) <= 200
    assert {clip["error"] for clip in library.clips} == {None}
    assert all((library.folder / loop).is_file() for loop in loops)


def test_a_name_that_fits_is_as_it_was():
    assert fitting("walk", "_loop.bvh") == "walk_loop.bvh"
    whole = "é" * 200
    short = fitting(whole, "_loop.bvh")
    assert len(short.encode()) in (119, 120)
    assert short.startswith("é" * 40)
    assert short != fitting(whole + "é", "_loop.bvh")


def test_the_loops_of_another_library_are_not_eaten(source, library, tmp_path):
    inside = tmp_path / "source"
    shutil.copytree(source, inside)
    shutil.copytree(library.folder, inside / "older")
    shutil.copytree(source, inside / "loops")
    assert [clip["file"] for clip in built(inside, tmp_path / "new").clips] == [
        "a.bvh",
        "loops/a.bvh",
    ]


def test_no_two_processes_write_to_one_name(tmp_path):
    with written_beside(tmp_path / "a.bvh") as one, written_beside(tmp_path / "a.bvh") as other:
        assert one != other
        assert is_part(one.name)
        for part in (one, other):
            part.write_text(part.name)
    assert not is_part("a.bvh")
    assert not is_part(".walk.part.bvh")


def test_a_full_disk_names_the_file(tmp_path):
    with (
        pytest.raises(OSError, match="No space left") as raised,
        written_beside(tmp_path / "a.bvh"),
    ):
        raise OSError(28, "No space left on device")
    assert raised.value.filename == str(tmp_path / "a.bvh")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM", "SIGHUP", "SIGKILL"])
def test_a_run_that_is_ended_goes_on(source, library, tmp_path, number):
    for name in ("b.bvh", "c.bvh"):
        (tmp_path / "source").mkdir(exist_ok=True)
        shutil.copy(source / "a.bvh", tmp_path / "source" / name)
    whole = built(tmp_path / "source", tmp_path / "whole")
    folder = tmp_path / "library"
    arguments = ["library", tmp_path / "source", "-o", folder, "--jobs", "1"]
    command = [sys.executable, "-m", "roundelay", *map(str, arguments)]
    run = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    log = folder / "clips.jsonl"
    while run.poll() is None and not (log.exists() and b'"record"' in log.read_bytes()):
        time.sleep(0.01)
    run.send_signal(getattr(signal, number))
    _, said = run.communicate(timeout=60)
    if number == "SIGKILL":
        assert run.returncode == -signal.SIGKILL
    else:
        assert run.returncode in (0, 130)
        assert "Traceback" not in said
        assert not (folder / "library.lock").exists()
        assert rl.Library.open(folder).summary["clips"] >= 1
    assert told_of(built(tmp_path / "source", folder)) == told_of(whole)
    assert contents(folder) == contents(whole.folder)
