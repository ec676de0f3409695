"""Rules of the whole: public names, core dependencies, files that appear whole."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from roundelay.base.errors import FormatError
from roundelay.base.files import written_beside


def test_what_a_user_looks_at_is_shown_in_a_line(jumps, jump_cycles):
    assert repr(jumps) == "Motion('01_01', 2752 frames at 120 fps, 31 joints)"
    assert repr(jumps.skeleton) == "Skeleton(31 joints, root 'Hips')"
    assert repr(jump_cycles).startswith("[Cycle('01_01', period 1.8")
    assert len(repr(jump_cycles[0].evidence)) < 200


def test_the_core_runs_on_numpy_alone():
    """Blender has NumPy and nothing else."""
    code = """
import sys
others = "scipy sklearn matplotlib rich typer ezc3d ripser threadpoolctl duckdb usearch"
for name in others.split():
    sys.modules[name] = None
import roundelay as rl
from roundelay import synth
print(len(rl.find_cycles(synth.gait("walk").motion)[0].sample(30)))
"""
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "33"


def test_benchmarks_follow_the_library():
    """They are not run here, but what they import is there; peers they import when they run."""
    code = """
import importlib, pathlib
for path in pathlib.Path("benchmarks").glob("*.py"):
    importlib.import_module(f"benchmarks.{path.stem}")
    print(path.stem)
"""
    root = Path(__file__).parent.parent
    command = [sys.executable, "-c", code]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root)
    assert "limbs" in shown.stdout.split()


def test_an_interrupted_file_is_not_there(tmp_path):
    target = tmp_path / "result.json"
    target.write_text("old")

    def interrupted() -> None:
        with written_beside(target) as part:
            part.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_file_that_cannot_be_written_is_named_by_its_own_name(tmp_path):
    target = tmp_path / "missing" / "result.json"
    with pytest.raises(FileNotFoundError) as raised, written_beside(target) as part:
        part.write_text("whole")
    assert raised.value.filename == str(target)


def test_format_errors_tell_the_place():
    assert str(FormatError("expected x", path="a.bvh", line=3, column=7)) == "a.bvh:3:7: expected x"
    assert str(FormatError("expected x")) == "expected x"
