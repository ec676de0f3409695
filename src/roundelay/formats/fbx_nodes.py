"""Binary FBX 7.4: a tree of nodes, each a name with values and nodes of its own, as bytes.

The format has no public specification. What stands here agrees with what its readers accept:
Blender's two, ufbx and assimp.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

__all__ = ["CREATED", "FILE_ID", "VERSION", "Long", "Node", "Value", "encoded", "node"]

VERSION = 7400

# Readers may check that these three belong together: one valid set, so that files have no date.
CREATED = "1970-01-01 10:00:00:000"
FILE_ID = bytes.fromhex("28b32aebb624ccc2bfc8b02aa92bfcf1")
_FOOT_ID = bytes.fromhex("fabcab09d0c8d466b176fb831cf7267e")

_MAGIC = b"Kaydara FBX Binary  \x00\x1a\x00"
_LAST = bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")
_END = bytes(13)
_ARRAYS = {"<f4": b"f", "<f8": b"d", "<i4": b"i", "<i8": b"l"}


class Long(int):
    """A whole number of 64 bits; others have 32."""


Value = bool | Long | int | float | str | bytes | NDArray[Any]


@dataclass(frozen=True)
class Node:
    """Hold one node of the tree.

    Parameters
    ----------
    name : str
    values : tuple
        In the type the format wants: `Long` and int are different, and so are arrays of 32 and
        of 64 bits.
    inside : tuple of Node
    """

    name: str
    values: tuple[Value, ...] = ()
    inside: tuple[Node, ...] = ()


def node(name: str, *values: Value, inside: Iterable[Node] = ()) -> Node:
    """Make a node of a name, its values, and the nodes inside it."""
    return Node(name, values, tuple(inside))


def encoded(nodes: Iterable[Node]) -> bytes:
    """Return the bytes of a file that holds some nodes."""
    data = bytearray(_MAGIC + struct.pack("<I", VERSION))
    for one in nodes:
        _append(one, data)
    data += _END + _FOOT_ID + bytes(4)
    data += bytes(16 - len(data) % 16)
    data += struct.pack("<I", VERSION) + bytes(120) + _LAST
    return bytes(data)


def _append(one: Node, data: bytearray) -> None:
    """Append a node to the data; its head, which tells where it ends, is filled in at last."""
    start, name = len(data), one.name.encode("ascii")
    data += bytes(12) + bytes([len(name)]) + name
    head = len(data)
    for value in one.values:
        data += _packed(value)
    size = len(data) - head
    for child in one.inside:
        _append(child, data)
    if one.inside or not one.values:
        data += _END
    struct.pack_into("<III", data, start, len(data), len(one.values), size)


def _packed(value: Value) -> bytes:
    match value:
        case bool():
            return struct.pack("<c?", b"C", value)
        case Long():
            return struct.pack("<cq", b"L", value)
        case int():
            return struct.pack("<ci", b"I", value)
        case float():
            return struct.pack("<cd", b"D", value)
        case str():
            # Names of files may hold bytes that are no text.
            text = value.encode("utf-8", "replace")
            return struct.pack("<cI", b"S", len(text)) + text
        case bytes():
            return struct.pack("<cI", b"R", len(value)) + value
    kind = _ARRAYS[value.dtype.newbyteorder("<").str]
    plain = value.astype(value.dtype.newbyteorder("<")).tobytes()
    return struct.pack("<cIII", kind, value.size, 0, len(plain)) + plain
