"""A folder of captures such as people have: two bodies, names twice, one broken, one still."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth


def other_body(motion: rl.Motion) -> rl.Motion:
    """The same motion of a skeleton with other names."""
    names = tuple(f"Bip_{name}" for name in motion.skeleton.names)
    return replace(motion, skeleton=replace(motion.skeleton, names=names))


def write_gait(path: Path, kind: str, seed: int = 0, **options) -> rl.Motion:
    motion = synth.gait(kind, repetitions=2.6, seed=seed, start=0.1 * seed, **options).motion
    path.parent.mkdir(parents=True, exist_ok=True)
    rl.write(motion, path)
    return motion


@pytest.fixture
def clips(tmp_path) -> Path:
    """A walk and a run under the same name, in folders of two people."""
    folder = tmp_path / "clips"
    write_gait(folder / "anna" / "take.bvh", "walk", seed=1)
    write_gait(folder / "ben" / "take.bvh", "run", seed=2)
    return folder


@pytest.fixture(scope="session")
def shared(tmp_path_factory) -> Path:
    """A folder to read from only; see the module."""
    folder = tmp_path_factory.mktemp("clips")
    walk = write_gait(folder / "anna" / "walk.bvh", "walk", seed=1)
    write_gait(folder / "anna" / "punch.BVH", "punch", seed=2)
    write_gait(folder / "ben" / "walk.bvh", "walk", seed=3)
    write_gait(folder / "ben" / "jacks.bvh", "jacks", seed=4)
    rl.write(other_body(walk), folder / "ben" / "other.bvh")
    rl.write(rl.read(folder / "ben" / "walk.bvh"), folder / "ben" / "walk.amc")
    still = replace(
        walk,
        rotations=np.repeat(walk.rotations[:1], 300, axis=0),
        root_path=np.repeat(walk.root_path[:1], 300, axis=0),
    )
    rl.write(still, folder / "still.bvh")
    (folder / "broken.bvh").write_text("HIERARCHY\nROOT Hips\n{\n")
    (folder / "._walk.bvh").write_bytes(b"\0\5\x16\7")
    (folder / "notes.txt").write_text("no capture")
    return folder


@pytest.fixture(scope="session")
def made(shared, tmp_path_factory) -> tuple[rl.Library, list[str]]:
    """The library of it, and what was said of refused files."""
    refused: list[str] = []
    folder = tmp_path_factory.mktemp("library")
    return rl.build_library(shared, folder, jobs=1, refused=refused.append), refused
