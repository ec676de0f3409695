"""How commands end when they are told to, or when the disk is full."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

import roundelay as rl
from roundelay import synth

pytestmark = pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals or limits")
PROGRAM = [sys.executable, "-m", "roundelay"]


@pytest.fixture
def walk(tmp_path):
    path = tmp_path / "walk.bvh"
    rl.write(synth.gait("walk", repetitions=4, seed=1).motion, path)
    return path


@pytest.mark.parametrize("milliseconds", [80, 160, 320, 480, 640, 960])
def test_a_signal_at_any_time_is_no_traceback(walk, tmp_path, milliseconds):
    """Ctrl-C while Python itself starts is Python's; from then on it is ours."""
    command = [*PROGRAM, "loop", walk, "-o", tmp_path / "out"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    run = subprocess.Popen(command, **pipes)
    time.sleep(milliseconds / 1e3)
    run.send_signal(signal.SIGTERM)
    said, complained = run.communicate(timeout=60)
    assert run.returncode in (0, 130, -signal.SIGINT, -signal.SIGTERM)
    assert "Traceback" not in said + complained
    left = [path.name for path in (tmp_path / "out").glob(".*")]
    assert left == []


def test_hang_ups_stay_ignored_where_they_are(walk, tmp_path):
    """As by nohup."""
    command = [*PROGRAM, "loop", walk, "-o", tmp_path / "out", "--no-picture"]

    def ignore() -> None:
        signal.signal(signal.SIGHUP, signal.SIG_IGN)

    run = subprocess.Popen(command, preexec_fn=ignore, stdout=subprocess.DEVNULL)
    time.sleep(0.3)
    run.send_signal(signal.SIGHUP)
    assert run.wait(60) == 0


@pytest.mark.parametrize(
    ("command", "file"),
    [
        (["loop", "walk.bvh", "-o", "out"], "out/walk_loop.bvh"),
        (["timeline", "walk.bvh", "-o", "out"], "out/walk_timeline.json"),
        (["convert", "walk.bvh", "out.glb"], "out.glb"),
        (
            ["library", "walk.bvh", "-o", "out", "--jobs", "1"],
            "walk.bvh: {}/out/loops/walk.bvh/walk_loop.bvh",
        ),
    ],
)
def test_a_full_disk_names_the_file(walk, tmp_path, command, file):
    """A limit on the size of files stands for a disk without room."""
    limited = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000));"
        "from roundelay.__main__ import main; sys.argv[0] = 'roundelay'; main()"
    )
    run = subprocess.run(
        [sys.executable, "-c", limited, *command], capture_output=True, text=True, cwd=tmp_path
    )
    assert run.returncode == 2
    first, *others = run.stderr.splitlines()
    assert first == f"roundelay: {file.format(tmp_path)}: File too large"
    # A library goes on to its tables, which have no room either.
    assert all(line.endswith("File too large") and "library.duckdb" in line for line in others)
    assert [path.name for path in tmp_path.rglob(".*")] == []
