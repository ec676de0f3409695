"""Files by a grammar: mostly as programs write them, here and there as none does."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from typing import Any

from tests.fuzz.chance import Chance, Files, encoded
from tests.fuzz.point_grammar import POINTS

__all__ = ["FORMATS", "Files", "made"]

_Element = tuple[str, list[Any], list[Any]]

_AXES = ("X", "Y", "Z")


def made(kind: str, seed: int) -> Files:
    """Make the files of a capture of a format: the same for the same seed."""
    chance = Chance(f"{kind} {seed}")
    # Half of all files are as they should be, so that readers get to their ends.
    chance.wild = chance.choice((0.0, 0.0, 0.002, 0.02))
    return FORMATS[kind](chance)


def _bvh(chance: Chance) -> Files:
    parents = chance.tree(6)
    channels: list[int] = []
    pieces = [chance.word("HIERARCHY"), chance.blank(), _joint(chance, 0, parents, channels)]
    frames, width = chance.randint(1, 12), sum(channels)
    pieces += [chance.word("MOTION"), chance.blank()]
    pieces.append(f"{chance.word('Frames:')} {chance.count(frames)}{chance.blank()}")
    time = chance.choice(("0.0083333", "0.04", "1", "1e-3"))
    time = chance.number() if chance.is_wild() else time
    pieces.append(f"{chance.word('Frame Time:')} {time}{chance.blank()}")
    pieces += [chance.numbers(width) + chance.blank() for _ in range(frames)]
    return {"a.bvh": encoded(chance, "".join(pieces))}


def _joint(chance: Chance, joint: int, parents: list[int], channels: list[int]) -> str:
    kind = chance.word("JOINT" if joint else "ROOT")
    pieces = [f"{kind} {chance.name(joint)}{chance.blank()}{{{chance.blank()}"]
    pieces.append(f"{chance.word('OFFSET')} {chance.numbers(3, 20.0)}{chance.blank()}")
    own = chance.sample(_AXES, 3) if chance.random() < 0.9 else chance.choices(_AXES, k=2)
    words = [f"{axis}rotation" for axis in own]
    if not joint or chance.random() < 0.1:
        words = [f"{axis}position" for axis in _AXES] + words
    channels.append(len(words))
    told = " ".join(map(chance.word, words))
    count = chance.count(len(words))
    pieces.append(f"{chance.word('CHANNELS')} {count} {told}{chance.blank()}")
    children = [child for child, parent in enumerate(parents) if parent == joint and child]
    pieces += [_joint(chance, child, parents, channels) for child in children]
    if not children:
        end = chance.numbers(3, 20.0)
        pieces.append(f"{chance.word('End Site')} {{ {chance.word('OFFSET')} {end} }}\n")
    return "".join([*pieces, "}", chance.blank()])


def _acclaim(chance: Chance) -> Files:
    parents = chance.tree(6)
    dofs = [chance.sample(("rx", "ry", "rz"), chance.randint(0, 3)) for _ in parents]
    names = ["root", *(chance.name(joint) for joint in range(1, len(parents)))]
    asf = _asf(chance, parents, names, dofs)
    lines = [chance.word(":FULLY-SPECIFIED"), chance.word(":DEGREES")]
    for frame in range(chance.randint(1, 9)):
        lines += [str(chance.count(frame + 1)), f"root {chance.numbers(6)}"]
        lines += [
            f"{name} {chance.numbers(len(dof))}"
            for name, dof in zip(names[1:], dofs[1:], strict=True)
            if dof
        ]
    amc = chance.blank().join(lines) if chance.is_wild() else "\n".join(lines)
    return {"a.amc": encoded(chance, amc + "\n"), "a.asf": encoded(chance, asf)}


def _asf(chance: Chance, parents: list[int], names: list[str], dofs: list[list[str]]) -> str:
    word = chance.word
    lines = [word(":version") + " 1.10", word(":units"), "mass 1.0", f"length {chance.number(1.0)}"]
    lines = [*lines[:3], "length 0.45" if chance.random() < 0.9 else lines[3], "angle deg"]
    lines += [word(":root"), "order TX TY TZ RX RY RZ", "axis XYZ", f"position {chance.numbers(3)}"]
    lines += ["orientation 0 0 0", word(":bonedata")]
    for joint, name in list(enumerate(names))[1:]:
        lines += [word("begin"), f"id {chance.count(joint)}", f"name {name}"]
        lines += [
            f"direction {chance.numbers(3, 1.0)}",
            f"length {abs(chance.uniform(0.1, 9)):.3f}",
        ]
        lines.append(f"axis {chance.numbers(3)} {chance.choice(('XYZ', 'ZYX'))}")
        if dofs[joint]:
            lines.append(f"dof {' '.join(dofs[joint])}")
            lines += ["limits (-180 180)", *["(-180 180)"] * (len(dofs[joint]) - 1)]
        lines.append(word("end"))
    lines += [word(":hierarchy"), word("begin")]
    for parent, name in enumerate(names):
        children = [
            names[child] for child, above in enumerate(parents) if above == parent and child
        ]
        lines += [f"{name} {' '.join(children)}"] if children else []
    return "\n".join([*lines, word("end")]) + "\n"


def _document(chance: Chance) -> tuple[dict[str, Any], bytes]:
    """Return a glTF and its buffer."""
    parents, frames = chance.tree(6), chance.randint(1, 9)
    nodes: list[dict[str, Any]] = [
        {"name": chance.name(joint), "translation": _vector(chance, 3)}
        for joint in range(len(parents))
    ]
    for joint, parent in enumerate(parents[1:], 1):
        nodes[parent].setdefault("children", []).append(chance.count(joint))
    data, views, accessors = bytearray(), list[dict[str, Any]](), list[dict[str, Any]]()

    def accessor(values: list[list[float]], kind: str) -> int:
        views.append(
            {"buffer": 0, "byteOffset": len(data), "byteLength": 4 * len(values) * len(values[0])}
        )
        data.extend(
            struct.pack(f"<{len(values) * len(values[0])}f", *(x for row in values for x in row))
        )
        told = {"bufferView": len(views) - 1, "componentType": 5126, "type": kind}
        accessors.append(told | {"count": chance.count(len(values))})
        return len(accessors) - 1

    times = accessor([[0.04 * frame] for frame in range(frames)], "SCALAR")
    samplers, channels = list[dict[str, Any]](), list[dict[str, Any]]()
    for joint in range(len(parents)):
        path = "translation" if chance.random() < 0.2 else "rotation"
        turned = path == "rotation"
        values = [_unit(chance) if turned else _vector(chance, 3) for _ in range(frames)]
        output = accessor(values, "VEC4" if turned else "VEC3")
        mode = chance.choice(("LINEAR", "STEP", "CUBIC", 3)) if chance.is_wild() else "LINEAR"
        samplers.append({"input": times, "output": output, "interpolation": mode})
        target = {"node": chance.count(joint), "path": chance.word(path)}
        channels.append({"sampler": len(samplers) - 1, "target": target})
    document: dict[str, Any] = {
        "asset": {"version": chance.word("2.0")},
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "animations": [{"channels": channels, "samplers": samplers}],
        "bufferViews": views,
        "accessors": accessors,
        "buffers": [{"byteLength": chance.count(len(data))}],
    }
    if chance.random() < 0.5:
        document["skins"] = [{"joints": list(range(len(parents)))}]
    if chance.is_wild():
        del document[chance.choice(sorted(document))]
    return document, bytes(data)


def _vector(chance: Chance, count: int) -> list[float]:
    large = chance.choice((1e30, 1e-30, 1e12)) if chance.is_wild() else 1.0
    return [chance.uniform(-2.0, 2.0) * large for _ in range(count)]


def _unit(chance: Chance) -> list[float]:
    values = [chance.gauss(0.0, 1.0) for _ in range(4)]
    length = 0.0 if chance.is_wild() else sum(x * x for x in values) ** 0.5
    return [x / length if length else 0.0 for x in values]


def _gltf(chance: Chance) -> Files:
    document, data = _document(chance)
    for buffer in document.get("buffers", ()):
        buffer["uri"] = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
    return {"a.gltf": encoded(chance, json.dumps(document))}


def _glb(chance: Chance) -> Files:
    document, data = _document(chance)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    whole = 28 + len(text) + len(data)
    pieces = [b"glTF", struct.pack("<II", 2, chance.count(whole) & 0xFFFFFFFF)]
    pieces += [struct.pack("<I", chance.count(len(text)) & 0xFFFFFFFF), b"JSON", text]
    return {"a.glb": b"".join([*pieces, struct.pack("<I", len(data)), b"BIN\x00", data])}


def _fbx(chance: Chance) -> Files:
    parents = chance.tree(6)
    wide = chance.random() < 0.3
    objects, links = list[_Element](), list[_Element]()
    for joint, parent in enumerate(parents):
        name = f"{chance.name(joint)}\0\1Model"
        known = [("Lcl Translation", "", "", "A", *_vector(chance, 3))]
        known += [(chance.word("RotationOrder"), "enum", "", "", chance.count(joint % 6))]
        known += [("RotationActive", "bool", "", "", 1)] if chance.random() < 0.3 else []
        known += [("PreRotation", "Vector3D", "", "", *_vector(chance, 3))]
        objects.append(("Model", [100 + joint, name, "LimbNode"], [_properties(known)]))
        above = 100 + chance.count(parent) if parent >= 0 else 0
        links.append(("C", [chance.word("OO"), 100 + joint, above], []))
    objects.append(("AnimationStack", [1, "walk\0\1AnimStack", ""], []))
    objects.append(("AnimationLayer", [2, "\0\1AnimLayer", ""], []))
    links.append(("C", ["OO", 2, 1], []))
    _curves(chance, len(parents), objects, links)
    settings = _properties([("TimeMode", "enum", "", "", chance.choice((0, 6, 11)))])
    nodes: list[_Element] = [
        ("FBXHeaderExtension", [], [("FBXVersion", [7500 if wide else 7400], [])]),
        ("GlobalSettings", [], [settings]),
        (chance.word("Objects"), [], objects),
        (chance.word("Connections"), [], links),
    ]
    if chance.random() < 0.3:
        return {"a.fbx": encoded(chance, "; FBX 7.4.0 project file\n" + _fbx_text(nodes))}
    head = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7500 if wide else 7400)
    body = bytearray(head)
    for one in nodes:
        _fbx_element(chance, one, wide, body)
    return {"a.fbx": bytes(body + bytes(25 if wide else 13))}


def _properties(rows: list[tuple[Any, ...]]) -> _Element:
    return ("Properties70", [], [("P", list(row), []) for row in rows])


def _curves(chance: Chance, joints: int, objects: list[_Element], links: list[_Element]) -> None:
    frames = chance.randint(1, 9)
    ticks = [46_186_158_000 // 30 * frame for frame in range(frames)]
    for joint in range(joints):
        kind, of = ("T", "Lcl Translation") if chance.random() < 0.2 else ("R", "Lcl Rotation")
        group = 1000 + 10 * joint
        objects.append(("AnimationCurveNode", [group, f"{kind}\0\1AnimCurveNode", ""], []))
        links.append(("C", ["OO", group, 2], []))
        links.append(("C", ["OP", group, 100 + chance.count(joint), of], []))
        for axis in range(3):
            values = [float(chance.uniform(-90.0, 90.0)) for _ in range(chance.count(frames) % 99)]
            flags = [chance.choice((0x6104, 0x6108, 0x408, 0x108, 2, 0x102)) for _ in ticks]
            inside: list[_Element] = [("KeyTime", [ticks], []), ("KeyValueFloat", [values], [])]
            inside += [("KeyAttrFlags", [flags], []), ("KeyAttrRefCount", [[1] * frames], [])]
            inside += [("KeyAttrDataFloat", [[0.0] * (4 * frames)], [])]
            objects.append(("AnimationCurve", [group + axis + 1, "\0\1AnimCurve", ""], inside))
            links.append(("C", ["OP", group + axis + 1, group, f"d|{'XYZ'[axis]}"], []))


def _fbx_element(chance: Chance, one: _Element, wide: bool, data: bytearray) -> None:
    name, values, inside = one
    form = "<QQQ" if wide else "<III"
    start, size = len(data), struct.calcsize(form)
    data.extend(bytes(size) + bytes([len(name)]) + name.encode())
    first = len(data)
    for value in values:
        data.extend(_fbx_value(chance, value))
    length = len(data) - first
    for inner in inside:
        _fbx_element(chance, inner, wide, data)
    data.extend(bytes(size + 1) if inside else b"")
    limit = 2**32 - 1
    told = min(chance.count(len(data)), limit), min(chance.count(len(values)), limit), length
    struct.pack_into(form, data, start, *told)


def _fbx_value(chance: Chance, value: Any) -> bytes:
    match value:
        case str():
            raw = value.encode("utf-8", "replace")
            return struct.pack("<cI", b"S", min(chance.count(len(raw)), 2**32 - 1)) + raw
        case float():
            return struct.pack("<cd", b"D", value)
        case int():
            return struct.pack("<cq", b"L", value)
    kind, form = ("d", "d") if value and isinstance(value[0], float) else ("l", "q")
    raw = struct.pack(f"<{len(value)}{form}", *value)
    packed = chance.random() < 0.5
    raw = zlib.compress(raw) if packed else raw
    count = min(chance.count(len(value)), 2**32 - 1)
    return struct.pack("<cIII", kind.encode(), count, packed, len(raw)) + raw


def _fbx_text(nodes: list[_Element]) -> str:
    pieces = []
    for name, values, inside in nodes:
        listed = ", ".join(_fbx_word(value) for value in values)
        body = f" {{\n{_fbx_text(inside)}}}" if inside else ""
        pieces.append(f"{name}: {listed}{body}\n")
    return "".join(pieces)


def _fbx_word(value: Any) -> str:
    if isinstance(value, str):
        return '"' + "::".join(reversed(value.split("\0\1"))).replace('"', "&quot;") + '"'
    if isinstance(value, list):
        return f"*{len(value)} {{ a: {','.join(map(repr, value))} }}"
    return repr(value)


FORMATS = {
    "fbx": _fbx,
    "bvh": _bvh,
    "amc": _acclaim,
    "gltf": _gltf,
    "glb": _glb,
    **POINTS,
}
"""What makes the files of each format."""
