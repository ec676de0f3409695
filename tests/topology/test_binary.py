"""The binary of the kernel: which is loaded, and that it answers as any other."""

from __future__ import annotations

import re
import sys
import sysconfig
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from roundelay.topology.kernel import compiled
from roundelay.topology.kernel.compiled import Compiled
from roundelay.topology.kernel.twin import Twin
from topology.recorded import CASES, RECORDED, answered, asked, hashed


@pytest.mark.parametrize("name", CASES)
def test_recorded_answers_are_given_to_the_bit(name: str) -> None:
    assert hashed(answered(Compiled(), CASES[name])) == RECORDED[name]


@pytest.mark.parametrize("name", ["ties", "cloud"])
def test_the_twin_gives_them_but_for_the_last_digits_of_the_smoothing(name: str) -> None:
    case = CASES[name]
    ours, twin = answered(Compiled(), case), answered(Twin(), case)
    smoothed = 8 * (len(case.points) + 1)
    assert ours[:-smoothed] == twin[:-smoothed]
    np.testing.assert_allclose(
        np.frombuffer(ours[-smoothed:]), np.frombuffer(twin[-smoothed:]), atol=1e-7
    )


def test_another_bit_is_another_hash() -> None:
    points = CASES["circle"].points.copy()
    points.view(np.uint32)[3, 1] ^= 1
    moved = replace(CASES["circle"], points=points)
    assert hashed(answered(Compiled(), moved)) != RECORDED["circle"]
    assert asked(moved) != asked(CASES["circle"])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder in which the kernel is looked for."""
    monkeypatch.setattr(compiled, "_FOLDER", tmp_path)
    return tmp_path


SYSTEMS = {
    "_kernel-linux-x86_64.so": ("linux", "linux-x86_64", "x86_64"),
    "_kernel-linux-aarch64.so": ("linux", "linux-aarch64", "aarch64"),
    "_kernel-win-amd64.dll": ("win32", "win-amd64", "ARM64"),  # emulated: what Python is counts
    "_kernel-win-arm64.dll": ("win32", "win-arm64", "ARM64"),
    "_kernel-macosx-x86_64.dylib": ("darwin", "macosx-10.13-universal2", "x86_64"),
    "_kernel-macosx-arm64.dylib": ("darwin", "macosx-10.13-universal2", "arm64"),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_of_many_binaries_that_of_the_system_is_taken(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    system, python, machine = SYSTEMS[name]
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(sysconfig, "get_platform", lambda: python)
    monkeypatch.setattr("platform.machine", lambda: machine)
    for other in SYSTEMS:
        (folder / other).touch()
    assert compiled._binary() == folder / name
    (folder / "_kernel.so").touch()
    assert compiled._binary() == folder / "_kernel.so"


def test_without_a_binary_for_the_system_it_is_named(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sysconfig, "get_platform", lambda: "linux-riscv64")
    monkeypatch.setattr(sys, "platform", "linux")
    (folder / "_kernel-linux-x86_64.so").touch()
    (folder / "_kernel.lib").touch()
    with pytest.raises(OSError, match=re.escape(f"no binary for linux-riscv64 in {folder}")):
        Compiled()
