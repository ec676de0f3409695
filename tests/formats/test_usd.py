"""USD by usd-core, where that is installed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.formats import contents_of


@pytest.fixture(scope="module")
def walk():
    return synth.gait("walk", repetitions=1, fps=30).motion[:8]


def test_without_the_library_the_extra_is_named(tmp_path, walk, monkeypatch):
    monkeypatch.setattr("roundelay.formats.apart.importlib.util.find_spec", lambda name: None)
    (tmp_path / "a.usda").write_text("#usda 1.0")
    with pytest.raises(rl.FormatError, match=r"found none: install roundelay\[usd\]"):
        rl.read(tmp_path / "a.usda")
    with pytest.raises(rl.FormatError, match=r"install roundelay\[usd\]"):
        rl.write(walk, tmp_path / "b.usda")
    assert not (tmp_path / "b.usda").exists()


@pytest.mark.parametrize("suffix", ["usda", "usdc"])
def test_a_motion_comes_back(tmp_path, walk, suffix):
    pytest.importorskip("pxr")
    moved = np.tile(walk.skeleton.offsets, (len(walk), 1, 1))
    moved[:, 3, 1] += 0.01 * np.arange(len(walk))
    path, motion = tmp_path / f"a.{suffix}", replace(walk, translations=moved)
    rl.write(motion, path)
    again = rl.read(path)
    assert (again.skeleton.names, again.skeleton.parents) == (
        walk.skeleton.names,
        walk.skeleton.parents,
    )
    assert (len(again), again.up) == (len(walk), walk.up)
    assert again.fps == pytest.approx(30)
    assert np.allclose(again.positions(), motion.positions(), atol=1e-5)
    assert contents_of(path).conventions["up"] == "Y"


def test_names_that_usd_does_not_allow(tmp_path, walk):
    pytest.importorskip("pxr")
    names = ("a:Hips", "a_Hips", "1", *walk.skeleton.names[3:])
    skeleton = replace(walk.skeleton, names=names)
    rl.write(replace(walk, skeleton=skeleton), tmp_path / "a.usda")
    assert rl.read(tmp_path / "a.usda").skeleton.names[:3] == ("a_Hips", "a_Hips_2", "_1")


@pytest.mark.parametrize(
    ("text", "message"),
    [("#usda 1.0\n", "expected a skeleton, found none"), ("no usd", "found: ")],
)
def test_what_is_none_is_told(tmp_path, text, message):
    pytest.importorskip("pxr")
    (tmp_path / "a.usda").write_text(text)
    with pytest.raises(rl.FormatError, match=message):
        rl.read(tmp_path / "a.usda")
