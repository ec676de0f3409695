"""HDF5 files of DeepLabCut and SLEAP, with and without the library that reads them."""

from __future__ import annotations

import importlib.util
import warnings
from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay.formats import animals, apart
from roundelay.formats.registry import contents_of

MAGIC = b"\x89HDF\r\n\x1a\n"
X = np.random.default_rng(0).uniform(0.0, 500.0, (12, 2, 3, 2))

with_movement = pytest.mark.skipif(
    importlib.util.find_spec("movement") is None, reason="needs the extra animals"
)


def test_without_the_library_a_refusal_names_the_way(tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    (tmp_path / "a.h5").write_bytes(MAGIC)
    with pytest.raises(rl.FormatError, match=r"install roundelay\[animals\]"):
        rl.read_points(tmp_path / "a.h5")


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("import sys; sys.exit('no poses')", "DeepLabCut or SLEAP, found: no poses"),
        ("import os; os.abort()", "DeepLabCut or SLEAP, found: exit code"),
        ("import time; time.sleep(60)", "expected a file that is read in 2 s"),
    ],
)
def test_a_process_that_ends_badly_is_one_error(tmp_path, monkeypatch, code, told):
    """As native code does that a broken file brings down."""
    (tmp_path / "badly_ending.py").write_text(code)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setattr(animals, "_MOVEMENT", replace(animals._MOVEMENT, child="badly_ending"))
    monkeypatch.setattr(apart, "_SECONDS", 2.0)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    (tmp_path / "a.h5").write_bytes(MAGIC)
    with pytest.raises(rl.FormatError, match=told):
        rl.read_points(tmp_path / "a.h5")


@with_movement
@pytest.mark.parametrize("program", ["deeplabcut", "sleap"])
def test_files_of_the_programs(tmp_path, program):
    path = tmp_path / "a.h5"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from movement.io import load_poses, save_poses

        names = {"individual_names": ["one", "two"], "keypoint_names": ["nose", "hip", "tail"]}
        told = load_poses.from_numpy(X.transpose(0, 3, 2, 1), **names)
        if program == "sleap":
            save_poses.to_sleap_analysis_file(told, path)
        else:
            save_poses.to_dlc_file(told, path, split_individuals=False)
        found = rl.read_points(path, character="two")
    assert found.names == ("two:nose", "two:hip", "two:tail")
    assert (found.image, found.units, found.fps) == (True, "px", 30.0)
    assert np.allclose(found.positions, X[:, 1])
    assert contents_of(path).characters == ("one", "two")


@with_movement
def test_half_a_file_is_refused(tmp_path):
    (tmp_path / "a.h5").write_bytes(MAGIC + b"\0" * 500)
    with pytest.raises(rl.FormatError, match="DeepLabCut or SLEAP, found: "):
        rl.read_points(tmp_path / "a.h5")
