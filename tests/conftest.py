"""Shared fixtures: the bundled captures, read once."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest
from tests.chromium import chromium

import roundelay as rl

__all__ = ["chromium"]

CAPTURES = Path(__file__).parent.parent / "data" / "captures"


@pytest.fixture(scope="session")
def captures() -> Path:
    """The folder of bundled captures."""
    return CAPTURES


@pytest.fixture(scope="session")
def jumps() -> rl.Motion:
    """CMU 01_01: ten forward jumps, with a T-pose in front."""
    return rl.read(CAPTURES / "01_01.bvh")


@pytest.fixture(scope="session")
def jump_cycles(jumps: rl.Motion) -> list[rl.Cycle]:
    """What the main job finds in the jumps."""
    return rl.find_cycles(jumps)


@pytest.fixture(scope="session")
def jump_loops(jumps: rl.Motion) -> list[rl.Loop]:
    """Their loops, as ``roundelay loop`` writes them."""
    return rl.make_loops(jumps)


@pytest.fixture(scope="session")
def boxing() -> rl.Motion:
    """Free sparring and a fall; its file holds one line too many."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return rl.read(CAPTURES / "Boxing_Toes.bvh")
