"""The examples of docs/extending.md, as a package of a stranger: they work, and pass the checks."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pytest

import roundelay as rl
from plugins import install, python, roundelay
from roundelay import synth

PAGE = Path(__file__).parent.parent / "docs" / "extending.md"


@pytest.fixture(scope="module")
def scratch(tmp_path_factory) -> Path:
    """A folder with all files of the page, their entry points, and a walk as BVH."""
    text = PAGE.read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n# (\S+\.py)\n(.*?)```", text, re.DOTALL)
    (points,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    folder = tmp_path_factory.mktemp("extending")
    install(folder, dict(blocks), tomllib.loads(points)["project"]["entry-points"])
    rl.write(synth.gait("walk", repetitions=4.3, fps=60).motion, folder / "walk.bvh")
    return folder


def test_every_example_passes_its_check(scratch):
    tests = sorted(path.name for path in scratch.glob("test_*.py"))
    assert len(tests) == 5
    shown = python(scratch, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests)
    assert shown.returncode == 0, shown.stdout
    assert "5 passed" in shown.stdout


def test_every_example_is_used_from_python(scratch):
    code = """
import roundelay as rl
rl.write(rl.read("walk.bvh"), "walk.pose")
motion = rl.read("walk.pose")
print(len(motion), motion.name)
cycle = rl.find_cycles(motion, rl.Options(method="plain", proposers=("lag",)))[0]
print(round(cycle.period, 2), len(cycle.pose.frequencies))
print(rl.segment(motion, method="steady").cuts)
from my_steady import SteadyOptions
found = rl.segment(motion, method=SteadyOptions(seconds=1.0))
print(found.method, found.cuts, found.to_dict()["options"])
"""
    shown = python(scratch, "-W", "error", "-c", code)
    assert shown.stderr == ""
    assert shown.stdout.splitlines() == [
        "284 walk",
        "1.1 4",
        "(120, 240)",
        "steady (60, 120, 180, 240) {'seconds': 1.0}",
    ]


def test_every_example_is_used_from_the_command_line(scratch):
    assert roundelay(scratch, "convert walk.bvh cli.pose").returncode == 0
    chosen = "--method plain --profile markers --format pose --no-picture -o loops"
    shown = roundelay(scratch, f"loop cli.pose {chosen}")
    assert shown.returncode == 0, shown.stderr
    record = json.loads((scratch / "loops" / "cli_loop.json").read_text())
    (cycle,) = record["cycles"]
    assert record["options"]["method"] == "plain"
    assert cycle["files"] == ["cli_loop.pose"]
    assert cycle["playback"] == {"frames": 66, "markers": [0.0, 16.5, 33.0, 49.5]}
    shown = roundelay(scratch, "segment cli.pose --cut-by steady --no-picture --json")
    assert json.loads(shown.stdout)["method"] == "steady"


def test_a_library_takes_a_format_of_a_stranger(scratch):
    (scratch / "clips").mkdir()
    assert roundelay(scratch, "convert walk.bvh clips/a.pose").returncode == 0
    shown = roundelay(scratch, "library clips -o made --jobs 2 --format pose")
    assert shown.returncode == 0, shown.stderr
    assert (scratch / "made" / "loops" / "a.pose" / "a_loop.pose").exists()


@pytest.mark.parametrize(
    ("command", "listed"),
    [
        (
            "loop",
            "BVH, AMC, GLB, GLTF, VRM, VRMA, FBX, or POSE files, bvh, amc, glb, gltf, fbx, pose. "
            "generic, markers.",
        ),
        ("convert", "The BVH, AMC, GLB, GLTF, FBX, or POSE file to write;"),
        ("segment", "gaussian, pca, ppca, gmm, steady, pca-paper, ppca-paper, gmm-paper."),
    ],
)
def test_help_lists_what_a_stranger_brings(scratch, command, listed):
    shown = roundelay(scratch, f"{command} --help")
    # The columns of a narrow terminal part the words.
    words = re.sub(r"[│\s]+", " ", shown.stdout)
    assert all(word in words.split() for word in listed.split()), words
    assert "{" not in re.sub(r"\{(CAPTURE|TARGET)\}", "", words)


def test_errors_list_what_a_stranger_brings(scratch):
    shown = roundelay(scratch, "convert walk.bvh walk.xyz")
    assert "a file of type .bvh, .amc, .glb, .gltf, .fbx, " in shown.stderr
    assert ", .pose, found" in shown.stderr
