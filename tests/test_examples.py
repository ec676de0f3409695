"""The examples in the docstrings of public names: they run, and print what they say."""

import doctest
import inspect
import shutil

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth

# What is raised is shown where it is caught: by the base class and those that users meet.
WITHOUT = {"LiftError", "Locked", "TooLarge", "Unsolvable"}
NAMES = [name for name in rl.__all__ if not inspect.ismodule(getattr(rl, name))]
KEYPOINTS = {
    f"{side}{joint}": f"{side.lower()}_{point}"
    for side in ("Left", "Right")
    for joint, point in (
        ("Arm", "shoulder"),
        ("ForeArm", "elbow"),
        ("Hand", "wrist"),
        ("UpLeg", "hip"),
        ("Leg", "knee"),
        ("Foot", "ankle"),
    )
}


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    """The captures that the examples read."""
    folder = tmp_path_factory.mktemp("examples")
    (folder / "captures").mkdir()
    for kind, repetitions in (("walk", 6.5), ("run", 9.0)):
        motion = synth.gait(kind, repetitions=repetitions, fps=60.0).motion
        rl.write(motion, folder / f"{kind}.bvh")
        rl.write(motion, folder / "captures" / f"{kind}.bvh")
    walk = synth.gait("walk", repetitions=6.5, fps=60.0).motion
    places = walk.positions()[:, walk.skeleton.indices(KEYPOINTS)]
    keypoints = rl.Points(tuple(KEYPOINTS.values()), places, 60.0, units="m")
    rl.write(keypoints, folder / "keypoints.trc")
    (folder / "broken.bvh").write_text("no motion")
    return folder


@pytest.mark.parametrize("name", NAMES)
def test_examples_print_what_they_say(name, files, tmp_path, monkeypatch):
    shutil.copytree(files, tmp_path / "here")
    monkeypatch.chdir(tmp_path / "here")
    text = inspect.getdoc(getattr(rl, name)) or ""
    globs = {"rl": rl, "np": np}
    found = doctest.DocTestParser().get_doctest(text, globs, name, name, 0)
    assert found.examples or name in WITHOUT
    said: list[str] = []
    failed, _ = doctest.DocTestRunner(verbose=False).run(found, out=said.append)
    assert not failed, "".join(said)
