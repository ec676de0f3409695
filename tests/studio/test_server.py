"""What the studio's server answers, and what it refuses."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import zipfile
from io import BytesIO
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from tests.studio.conftest import running
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app

ENGINES = Path(__file__).parent.parent.parent / "engines"


def dropped(studio, path: Path, name: str = "") -> str:
    status, text = studio.ask(f"api/takes/{name or path.name}", "PUT", path.read_bytes())
    assert status == 200, text
    return json.loads(text)["name"]


def one(events, key):
    return next(event[key] for event in events if key in event)


def test_the_page_and_its_parts_are_served(studio):
    status, page = studio.ask("")
    assert status == 200
    assert "roundelay studio" in page
    for part in ("client/studio/main.js", "client/studio/studio.css", "client/page/track.js"):
        assert studio.ask(part)[0] == 200


def test_strangers_are_refused_in_one_line(studio):
    token = urlsplit(studio.url).path
    wrong = {
        "another token": (f"/{'x' * 32}/", {}),
        "no token": ("/", {}),
        "another host": (token, {"Host": "evil.example"}),
        "another port": (token, {"Host": "127.0.0.1:1"}),
        "another name of this machine": (token, {"Host": f"localhost:{studio.port}"}),
        "another origin": (f"{token}api/takes", {"Origin": "https://evil.example"}),
        "no origin at all": (f"{token}api/takes", {"Origin": "null"}),
    }
    for what, (path, headers) in wrong.items():
        status, line = studio.fault(path, **headers)
        assert status == 403, what
        assert line.startswith("expected "), what
        assert "\n" not in line


@pytest.mark.parametrize(
    "path",
    [
        "client/studio/../../server.py",
        "client/studio/%2e%2e%2f%2e%2e%2fserver.py",
        "client/studio/server.py",
        "client/other/main.js",
        "api/exports/nothing/x.zip",
        "nowhere",
    ],
)
def test_nothing_else_is_served(studio, path):
    assert studio.ask(path)[0] == 404


@pytest.mark.parametrize(
    "name", ["..%2Fwalk.bvh", ".hidden.bvh", "walk.exe", "walk", "%00.bvh", "a%5Cb.bvh", "x%1b.bvh"]
)
def test_names_that_lead_elsewhere_are_refused(studio, name):
    status, _ = studio.ask(f"api/takes/{name}", "PUT", b"x")
    assert status in (400, 404)
    assert list(studio.folder.iterdir()) == []


def test_it_is_there_for_this_machine_alone(studio):
    held = subprocess.run(["ss", "-ltnH"], capture_output=True, text=True, check=False).stdout
    if f":{studio.port} " not in held:
        pytest.skip("needs ss of iproute2")
    own = next(line for line in held.splitlines() if f":{studio.port} " in line)
    assert own.split()[3] == f"127.0.0.1:{studio.port}"


def test_a_take_becomes_loops_in_events(studio, walk_file):
    dropped(studio, walk_file)
    events = studio.events("api/takes/walk.bvh/open", {})
    assert (events[0]["stored"], events[0]["revision"]) == (False, 0)
    order = [key for event in events for key in event if key in ("take", "work", "loop", "verdict")]
    # The take plays first, then its loop, and only then it is judged.
    assert order == ["take", "work", "loop", "loop", "verdict"]
    assert one(events, "work")["parts"][0]["motion"] == 1
    assert one(events, "verdict")["word"] == "good"
    assert one(events, "words")["command"] == "roundelay loop walk.bvh -o loops"
    assert all(0.0 <= event["progress"] <= 1.0 for event in events if "progress" in event)


def test_rubbish_is_one_line(studio, tmp_path):
    path = tmp_path / "bad.bvh"
    path.write_bytes(b"\x00rubbish" * 50)
    dropped(studio, path)
    line = studio.events("api/takes/bad.bvh/open", {})[-1]["error"]
    assert line.startswith("bad.bvh")
    assert "expected" in line
    assert "\n" not in line
    assert str(studio.folder) not in line
    for question in ("[]", "rubbish", "[" * 100_000):
        status, line = studio.fault("api/takes/bad.bvh/loops", "POST", question)
        assert (status, line[:8]) == (400, "expected")
    assert studio.fault("api/takes/missing.bvh/open", "POST", "{}")[0] == 400


def test_what_is_too_large_is_refused_before_it_is_sent(tmp_path):
    with running(tmp_path / "kept", "--largest", "1") as studio:
        claimed = {"Content-Length": "500000000"}
        status, line = studio.fault("api/takes/big.bvh", "PUT", None, **claimed)
        assert status == 413
        assert "expected a file of at most 1 MB, found 500 MB" in line
        status, line = studio.fault("api/takes/big.bvh", "PUT", b"x" * 1_500_000)
        assert status == 413
        assert list(studio.folder.iterdir()) == []


def test_a_killed_process_costs_the_job_alone(studio, walk_file):
    dropped(studio, walk_file)
    studio.events("api/takes/walk.bvh/open", {})
    for child in children(studio.process.pid):
        os.kill(child, signal.SIGKILL)
    time.sleep(0.3)
    events = studio.events("api/takes/walk.bvh/open", {})
    assert one(events, "verdict")["word"] == "good"


def test_a_process_killed_at_work_is_one_line(studio, two_file):
    dropped(studio, two_file)
    command = [sys.executable, "-c", f"""
import os, signal, time
time.sleep(1.2)
for child in {list(children(studio.process.pid))}:
    os.kill(child, signal.SIGKILL)
"""]  # fmt: skip
    killer = subprocess.Popen(command)
    last = studio.events("api/takes/two.bvh/open", {})[-1]
    killer.wait()
    if "error" in last:  # a fast machine is done before
        assert last["error"].startswith("the process that reads takes ended")
    assert studio.ask("api/takes")[0] == 200


def children(pid: int) -> list[int]:
    """The processes that do the work: not the one that tracks resources."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = path.read_text().rpartition(")")[2].split()
            line = path.with_name("cmdline").read_bytes()
        except OSError:
            continue
        if int(words[1]) == pid and b"spawn_main" in line:
            found.append(int(path.parent.name))
    if not found:
        pytest.skip("needs /proc")
    return found


def test_two_windows_do_not_overwrite_each_other(studio, walk_file):
    dropped(studio, walk_file)
    work = one(studio.events("api/takes/walk.bvh/open", {}), "work")

    def keep(name: str, revision: int) -> tuple[int, dict]:
        work["parts"][0]["name"] = name
        body = json.dumps({"work": work, "revision": revision})
        status, text = studio.ask("api/takes/walk.bvh/work", "PUT", body)
        return status, json.loads(text)

    status, first = keep("mine", 0)
    assert status == 200
    status, second = keep("theirs", 0)
    assert status == 409
    assert "another window has changed this work" in second["error"]
    kept = rl.read_work(studio.folder / "walk.work.json")
    assert kept.parts[0].name == "mine"
    assert keep("again", first["revision"])[0] == 200
    events = studio.events("api/takes/walk.bvh/open", {})
    assert events[0]["stored"] is True
    assert one(events, "work")["parts"][0]["name"] == "again"


def test_a_broken_work_file_is_one_line(studio, walk_file):
    dropped(studio, walk_file)
    (studio.folder / "walk.work.json").write_text("rubbish")
    status, line = studio.fault("api/takes/walk.bvh/open", "POST", "{}")
    assert status == 400
    assert line.startswith("walk.work.json: expected")
    assert "move it away" in line


@pytest.mark.parametrize("target", ["unity", "unreal", "godot", "blender", "web", None])
def test_an_export_is_what_the_command_writes(studio, walk_file, tmp_path, target):
    dropped(studio, walk_file)
    work = one(studio.events("api/takes/walk.bvh/open", {}), "work")
    work["parts"][0] = {"name": "stride", "spans": [[10, 200]]}
    events = studio.events("api/takes/walk.bvh/export", {"work": work, "target": target})
    data = studio.fetched(one(events, "link"))
    with zipfile.ZipFile(BytesIO(data)) as packed:
        assert packed.namelist() == one(events, "exported")
        packed.extractall(tmp_path / "zip")
    words = ["loop", "--work", str(tmp_path / "zip" / "walk.work.json"), "--no-picture"]
    (tmp_path / "zip" / "walk.bvh").write_bytes(walk_file.read_bytes())
    result = CliRunner().invoke(app, [*words, "-o", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    written = sorted((tmp_path / "out").iterdir())
    assert len(written) == 2
    for path in written:
        assert path.read_bytes() == (tmp_path / "zip" / path.name).read_bytes(), path.name


def test_the_importers_are_those_of_the_engines():
    from importlib.resources import files

    own = files("roundelay.studio").joinpath("importers")
    for name, source in {
        "unity.txt": "unity/RoundelayImporter.cs",
        "unreal.txt": "unreal/roundelay_import.py",
    }.items():
        assert own.joinpath(name).read_bytes() == (ENGINES / source).read_bytes()


def test_wrong_words_are_one_line(tmp_path):
    (tmp_path / "file").write_text("x")
    result = CliRunner().invoke(app, ["studio", str(tmp_path / "file"), "--no-browser"])
    assert result.exit_code == 2
    assert result.output.count("\n") == 1
    with running(tmp_path / "kept") as studio:
        words = ["studio", str(tmp_path / "other"), "--no-browser", "--port", str(studio.port)]
        result = CliRunner().invoke(app, words)
        assert (result.exit_code, result.output.count("\n")) == (2, 1)
        assert f"port {studio.port}" in result.output
