"""Any name that a file system allows, in every command, picture and page."""

from __future__ import annotations

import csv
import json
import os
import re
import unicodedata
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.base.cells import cell
from roundelay.base.texts import printable, shown
from roundelay.cli import app
from roundelay.output.figures import new_figure
from roundelay.output.figures import save as save_figure
from roundelay.output.figures.style import headed

WALK = synth.gait("walk", repetitions=2.6, seed=1, fps=30.0).motion
# Several kinds in one where the file system takes them.
NAMES = {
    "no text and a terminal's commands": os.fsdecode(b"\xe9\xff") + "\x1b[31ma\n\u2028b\u202ec\x07",
    "a formula, mathematics and a page": "=1+1$x$ \\alpha_{<script>alert(1)<!--",
    "an option and quotes": "-rf'b\"c`$(touch x)",
    "no font's": "歩く",
    "long": "n" * 240,
}
COMMANDS = {
    "loop": ["-o", "out"],
    "timeline": ["-o", "out"],
    "strides": ["-o", "out"],
    "inspect": ["-o", "out"],
    "excitations": ["-o", "out"],
    "reproduce": ["-o", "out"],
    "segment": ["-o", "out", "--split"],
    "view": ["-o", "out"],
    "close": ["--frames", "5:38", "-o", "out/"],
    "convert": ["out/"],
    "check": [],
    "blend": ["-o", "out/"],
    "transition": ["-o", "out/"],
    "library": ["-o", "out", "--jobs", "1"],
}


def arguments(command: str, capture: str) -> list[str]:
    given = [capture] * (2 if command in ("blend", "transition") else 1)
    if command == "convert":
        return [command, "--", *given, "out.glb"]
    return [command, *COMMANDS[command], "--", *given]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("name", NAMES)
def test_any_name(name, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    capture = f"{NAMES[name]}.bvh"
    try:
        rl.write(WALK, "walk.bvh")
        os.rename("walk.bvh", capture)
    except OSError:
        pytest.skip("this file system does not allow it")
    result = CliRunner().invoke(app, arguments(command, capture))
    assert result.exit_code == 0 or command == "check", result.output
    assert result.exception is None or isinstance(result.exception, SystemExit)
    said = result.output.replace("\n", "")
    assert not [x for x in said if unicodedata.category(x) in ("Cc", "Cs") or x == "\u202e"]
    assert "note" not in said
    for path in Path().rglob("*"):
        if path.suffix == ".csv":
            text = path.read_text(encoding="utf-8", errors="surrogateescape")
            cells = [one for row in csv.reader(text.splitlines()) for one in row]
            assert not [one for one in cells if re.match(r"[=+@\t\r]|-\D", one)]
        if path.suffix == ".json":
            json.loads(path.read_bytes())
        if path.suffix == ".glb":
            assert rl.read(path).n_frames
        if path.suffix == ".html":
            page = path.read_text(encoding="utf-8")
            assert "<script>alert" not in page


def test_what_is_shown():
    assert shown("walk ü 歩.bvh") == "walk ü 歩.bvh"
    assert shown("a\x1b[0m\x7f\x9b") == "a\\x1b[0m\\x7f\\x9b"
    assert shown("a\nb\tc") == "a\\x0ab\\x09c"
    assert printable("a\nb\tc\r\x07") == "a\nb\tc\\x0d\\x07"
    assert shown(os.fsdecode(b"\xff")) == "\\xff"
    assert shown("\ud83d\u2028\u202e\u200d") == "\\ud83d\\u2028\\u202e\u200d"
    assert shown(Path("a") / "b\x00") == f"a{os.sep}b\\x00"


@pytest.mark.parametrize("text", ["=1", "+1", "-1", "@a", "\t=1", "\r=1", "\n=1"])
def test_no_cell_is_a_formula(text):
    assert cell(text) == f"'{text}"
    assert cell(f"a{text}") == f"a{text}"


@pytest.mark.parametrize("suffix", ["glb", "gltf", "bvh", "amc"])
def test_a_motion_of_any_name_can_be_written_and_read(suffix, tmp_path):
    motion = replace(WALK, name=os.fsdecode(b"\xff\x1b"))
    rl.write(motion, tmp_path / f"a.{suffix}")
    assert len(rl.read(tmp_path / f"a.{suffix}")) == len(motion)


def test_a_heading_is_no_formula(tmp_path):
    figure = new_figure(2.0, 2.0)
    headed(figure, "$\\frac{$ \ud800")
    save_figure(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 0
    assert np.isfinite(figure.get_size_inches()).all()
