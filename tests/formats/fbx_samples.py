"""Motions that FBX files are made of: captures, loops, and what is rare."""

from __future__ import annotations

import base64
import struct
import warnings
import zlib
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

import roundelay as rl
from roundelay import synth
from roundelay.formats.fbx_binary import elements_of_binary
from roundelay.formats.fbx_elements import Element
from roundelay.formats.fbx_nodes import Node
from roundelay.geometry import rotations as rot

NAMES = (
    "01_01",
    "01_03",
    "Boxing_Toes",
    "loop",
    "z up",
    "x up",
    "moving",
    "one joint",
    "one frame",
    "names",
)


def made(name: str, captures: Path) -> rl.Motion:
    """Return a sample by its name."""
    if (captures / f"{name}.bvh").exists():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return rl.read(captures / f"{name}.bvh")
    return {
        "loop": _loop,
        "z up": lambda walk: turned(walk, 2),
        "x up": lambda walk: turned(walk, 0),
        "moving": _moving,
        "one joint": _one_joint,
        "one frame": lambda walk: walk[:1],
        "names": _named,
    }[name](synth.gait("walk", repetitions=3, turning=0.4, fps=30).motion)


def turned(motion: rl.Motion, up: int) -> rl.Motion:
    """Return a motion whose Y points up in a world where another axis does."""
    turn = rot.from_rotation_vector(np.array([[0, 0, -1], [0, 0, 0], [1, 0, 0]][up]) * np.pi / 2)
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    return replace(motion, rotations=rotations, root_path=rot.rotate(turn, motion.root_path), up=up)


def _loop(walk: rl.Motion) -> rl.Motion:
    return rl.find_cycles(walk)[0].sample(fps=30, repeat_first=True)


def _moving(walk: rl.Motion) -> rl.Motion:
    moved = np.tile(walk.skeleton.offsets, (len(walk), 1, 1))
    moved[:, 3, 1] += 0.1 * np.sin(np.arange(len(walk)))
    moved[:, 5, 0] += 0.05 * np.cos(np.arange(len(walk)))
    return replace(walk, translations=moved)


def _one_joint(walk: rl.Motion) -> rl.Motion:
    skeleton = rl.Skeleton(("only",), (-1,), np.array([[1.0, 2.0, 3.0]]))
    turns = rot.from_rotation_vector(np.linspace(0.0, 9.0, len(walk))[:, None, None] * np.ones(3))
    return replace(walk, skeleton=skeleton, rotations=turns)


def _named(walk: rl.Motion) -> rl.Motion:
    """Return names in other scripts, and ends that would be named like joints and each other."""
    old = walk.skeleton
    neck, names = old.index("Neck"), list(old.names)
    names[old.index("Spine")], names[old.index("Chest")] = "Rücken 背中", "Neck_end"
    ends = (*old.end_sites, (neck, np.array([0.0, 0.1, 0.0])), (neck, np.array([0.1, 0.0, 0.0])))
    skeleton = rl.Skeleton(tuple(names), old.parents, old.offsets, ends)
    return replace(walk, skeleton=skeleton, name="Gång")


def as_text(nodes: Iterable[Node]) -> bytes:
    """Return the nodes of a file as FBX in text."""
    lines = ["; FBX 7.4.0 project file", "; ----"]

    def add(one: Node, deep: str) -> None:
        values = ", ".join(map(_written, one.values))
        lines.append(f"{deep}{one.name}: {values}" + (" {" if one.inside else ""))
        for inner in one.inside:
            add(inner, deep + "\t")
        lines.extend([f"{deep}}}"] if one.inside else [])

    for one in nodes:
        add(one, "")
    return "\n".join(lines).encode()


def _written(value: object) -> str:
    match value:
        case bool():
            return "Y" if value else "N"
        case str():
            own, mark, kind = value.partition("\0\1")
            text = f"{kind}::{own}" if mark else value
            return '"' + text.replace('"', "&quot;") + '"'
        case bytes():
            return '"' + base64.b64encode(value).decode() + '"'
        case np.ndarray():
            numbers = ",".join(map(repr, value.tolist()))
            return f"*{value.size} {{\n a: {numbers}\n}}"
    return repr(value)


def as_wide(data: bytes) -> bytes:
    """Return a binary file of version 7.4 as one of 7.5, whose places have 64 bits."""
    version, root = elements_of_binary(Path("a.fbx"), data)
    assert version == 7400
    result = bytearray(data[:23] + struct.pack("<I", 7500))

    def add(one: Element) -> None:
        start, name = len(result), one.name.encode()
        result.extend(bytes(24) + bytes([len(name)]) + name)
        head = len(result)
        for value in one.values:
            result.extend(_packed(value))
        size = len(result) - head
        for inner in one.inside:
            add(inner)
        if one.inside:
            result.extend(bytes(25))
        struct.pack_into("<QQQ", result, start, len(result), len(one.values), size)

    for one in root.inside:
        add(one)
    return bytes(result + bytes(25))


def _packed(value: object) -> bytes:
    """Return a value in binary; arrays packed by zlib."""
    match value:
        case bool():
            return struct.pack("<c?", b"C", value)
        case int():
            return struct.pack("<cq", b"L", value)
        case float():
            return struct.pack("<cd", b"D", value)
        case str():
            return struct.pack("<cI", b"S", len(value.encode())) + value.encode()
        case bytes():
            return struct.pack("<cI", b"R", len(value)) + value
    kind = {"<f4": b"f", "<f8": b"d", "<i4": b"i", "<i8": b"l"}[value.dtype]
    content = zlib.compress(bytes(value.content))
    return struct.pack("<cIII", kind, value.count, 1, len(content)) + content
