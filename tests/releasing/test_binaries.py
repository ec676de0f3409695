"""What is read of a binary that cannot be run here; asked of the wheels where they were built."""

from __future__ import annotations

from pathlib import Path

import pytest

binaries = pytest.importorskip("release.binaries", reason="lief is needed: make wheels")
targets = pytest.importorskip("release.targets")
KERNELS = Path(__file__).resolve().parents[2] / "build" / "kernels"
pytestmark = pytest.mark.skipif(not KERNELS.is_dir(), reason="wheels are needed: make wheels")
TARGETS = {one.name: one for one in targets.TARGETS}


def told(name: str, data: bytes) -> list[str]:
    return list(binaries.faults(binaries.read(data, TARGETS[name]), TARGETS[name]))


def kernel(name: str) -> bytes:
    return (KERNELS / f"_kernel-{name}{TARGETS[name].suffix}").read_bytes()


@pytest.mark.parametrize("name", TARGETS)
def test_kernels_are_as_they_should_be(name: str) -> None:
    assert told(name, kernel(name)) == []


@pytest.mark.parametrize("name", TARGETS)
def test_another_interface_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(binaries, "_INTERFACE", 9)
    assert told(name, kernel(name)) == ["expected interface 9, found 2"]


@pytest.mark.parametrize("name", TARGETS)
def test_a_function_that_is_missing_is_found(name: str) -> None:
    # As long as the right name, and sorted where that one is.
    data = kernel(name).replace(b"roundelay_propagate", b"roundelay_propagatf")
    assert "expected all functions, found none called roundelay_propagate" in told(name, data)


def test_another_processor_is_found() -> None:
    data = kernel("win-arm64")
    assert "expected code for x86_64, found arm64" in told("win-amd64", data)


def test_another_system_is_refused() -> None:
    with pytest.raises(ValueError, match="expected a library for win-amd64"):
        told("win-amd64", kernel("linux-x86_64"))
    with pytest.raises(ValueError, match="expected a library for linux-x86_64"):
        told("linux-x86_64", b"no library")


def test_a_change_after_signing_is_found() -> None:
    data = bytearray(kernel("macosx-arm64"))
    place = data.index(b"roundelay_propagate")
    data[place] ^= 32
    faults = told("macosx-arm64", bytes(data))
    assert any(
        "expected a signature that fits the file, found another page" in one for one in faults
    )


def test_an_older_system_than_promised_is_asked_for() -> None:
    data = kernel("macosx-x86_64").replace(b"@rpath/_kernel.dylib", b"/rpath/_kernel.dylib")
    (fault,) = told("macosx-x86_64", data)
    assert fault.startswith("expected the install name @rpath/_kernel.dylib")
