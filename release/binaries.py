"""Reading a kernel that this machine cannot run: functions, libraries, versions, signature."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import lief

from release.targets import Target
from roundelay.topology.kernel.compiled import _INTERFACE, _SIGNATURES

__all__ = ["Binary", "faults", "read"]

FUNCTIONS = frozenset(f"roundelay_{name}" for name in _SIGNATURES)
# What a kernel may ask of its system: the C library, and nothing else.
LIBRARIES = {
    "linux": ("libc.so.6", "libm.so.6"),
    "win": ("KERNEL32.dll", "api-ms-win-crt-"),
    "macosx": ("/usr/lib/libSystem.B.dylib",),
}
INSTALL_NAME = "@rpath/_kernel.dylib"
_MACHINES = {
    lief.ELF.ARCH.X86_64: "x86_64",
    lief.ELF.ARCH.AARCH64: "arm64",
    lief.PE.Header.MACHINE_TYPES.AMD64: "x86_64",
    lief.PE.Header.MACHINE_TYPES.ARM64: "arm64",
    lief.MachO.Header.CPU_TYPE.X86_64: "x86_64",
    lief.MachO.Header.CPU_TYPE.ARM64: "arm64",
}
_KINDS = {"linux": lief.ELF.Binary, "win": lief.PE.Binary, "macosx": lief.MachO.Binary}


@dataclass
class Binary:
    """What was read of a kernel."""

    machine: str
    functions: frozenset[str]
    libraries: list[str]
    interface: int | None
    more: dict[str, Any] = field(default_factory=dict)


def read(data: bytes, target: Target) -> Binary:
    """Read a kernel.

    Raises
    ------
    ValueError
        If it is no shared library of the target's system.
    """
    system = target.name.partition("-")[0]
    lief.logging.disable()
    binary = lief.parse(list(data))
    if not isinstance(binary, _KINDS[system]):
        raise ValueError(f"expected a library for {target.name}, found {type(binary).__name__}")
    return {"linux": _elf, "win": _pe, "macosx": _macho}[system](binary, data)


def faults(binary: Binary, target: Target) -> Iterator[str]:
    """Say what is wrong with a kernel for a target, each as what is expected and was found."""
    system, _, machine = target.name.partition("-")
    machine = {"amd64": "x86_64", "aarch64": "arm64"}.get(machine, machine)
    if binary.machine != machine:
        yield f"expected code for {machine}, found {binary.machine}"
    if missing := FUNCTIONS - binary.functions:
        yield f"expected all functions, found none called {', '.join(sorted(missing))}"
    if binary.interface != _INTERFACE:
        yield f"expected interface {_INTERFACE}, found {binary.interface}"
    if strange := [name for name in binary.libraries if not name.startswith(LIBRARIES[system])]:
        yield f"expected no library but that of C, found {', '.join(strange)}"
    if system == "macosx":
        yield from _faults_of_macos(binary, target)


def _faults_of_macos(binary: Binary, target: Target) -> Iterator[str]:
    oldest, told = target.zig.partition("macos.")[2], binary.more
    if told["minimum"] != oldest:
        yield f"expected macOS {oldest} as the oldest, found {told['minimum']}"
    if told["install_name"] != INSTALL_NAME:
        yield f"expected the install name {INSTALL_NAME}, found {told['install_name']}"
    # Processors of Apple run signed code only; Intel's run any.
    if told["signature"] not in (("ad hoc",) if binary.machine == "arm64" else ("ad hoc", None)):
        yield f"expected a signature that fits the file, found {told['signature']}"


def _elf(binary: Any, data: bytes) -> Binary:
    defined = {one.name: one.value for one in binary.dynamic_symbols if one.value}
    versions = sorted(
        {one.name for need in binary.symbols_version_requirement
         for one in need.get_auxiliary_symbols()},
        key=lambda name: [int(part) for part in name.partition("_")[2].split(".")],
    )  # fmt: skip
    return Binary(
        _MACHINES.get(binary.header.machine_type, "another processor"),
        frozenset(defined),
        list(binary.libraries),
        _interface(binary, defined.get("roundelay_interface")),
        {"newest_glibc_asked": versions[-1] if versions else None},
    )


def _pe(binary: Any, data: bytes) -> Binary:
    defined = {one.name: one.address for one in binary.get_export().entries}
    return Binary(
        _MACHINES.get(binary.header.machine, "another processor"),
        frozenset(defined),
        [one.name for one in binary.imports],
        _interface(binary, defined.get("roundelay_interface")),
        {"time_stamp_or_hash": f"{binary.header.time_date_stamps:08x}"},
    )


def _macho(binary: Any, data: bytes) -> Binary:
    defined = {one.name.removeprefix("_"): one.value for one in binary.exported_symbols}
    told = binary.build_version.minos if binary.has_build_version else binary.version_min.version
    own, *others = (one.name for one in binary.libraries)
    signature = binary.code_signature if binary.has_code_signature else None
    return Binary(
        _MACHINES.get(binary.header.cpu_type, "another processor"),
        frozenset(defined),
        others,
        _interface(binary, defined.get("roundelay_interface")),
        {
            "minimum": ".".join(map(str, told[:2])),
            "install_name": own,
            "signature": signature and _signature(bytes(signature.content), data),
        },
    )


def _interface(binary: Any, address: int | None) -> int | None:
    """Return the number that `roundelay_interface` returns, from its instructions."""
    if address is None:
        return None
    code = bytes(binary.get_content_from_virtual_address(address, 16))
    (word,) = struct.unpack_from("<I", code)
    if word & 0xFFE0001F == 0x52800000:  # mov w0, #number
        return word >> 5 & 0xFFFF
    place = code.find(b"\xb8")  # mov eax, number
    return struct.unpack_from("<i", code, place + 1)[0] if 0 <= place < 11 else None


def _signature(blob: bytes, data: bytes) -> str:
    """Say what a signature is: ad hoc, with the hash of every page right, or what is wrong."""
    magic, _, count = struct.unpack_from(">3I", blob)
    if magic != 0xFADE0CC0 or not count:
        return "no signature of Apple's form"
    (start,) = struct.unpack_from(">I", blob, 16)
    _, _, _, flags, hashes, _, _, pages, end, size, kind, _, page = struct.unpack_from(
        ">9I4B", blob, start
    )
    if not flags & 2 or kind != 2:
        return "a signature that is not ad hoc by SHA-256"
    for k in range(pages):
        part = data[k << page : min((k + 1) << page, end)]
        place = start + hashes + k * size
        if hashlib.sha256(part).digest() != blob[place : place + size]:
            return f"another page {k} than was signed"
    return "ad hoc"
