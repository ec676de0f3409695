"""What stands in a glTF file: its JSON, checked where it is read, and the arrays of its accessors.

Format: Khronos glTF 2.0 specification (ISO/IEC 12113), chapters 3.6 (buffers, accessors) and 4
(GLB). Whatever a file says is compared with the bytes that are there before memory is taken for it.
"""

from __future__ import annotations

import base64
import json
import re
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn
from urllib.parse import unquote, unquote_to_bytes

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import content
from roundelay.formats.sane import LARGEST

__all__ = ["Document", "Part", "load"]

Array = NDArray[np.float64]

_MAGIC, _JSON, _BINARY = b"glTF", 0x4E4F534A, 0x004E4942
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_DATA_URI = re.compile(r"data:[^,]*,", re.IGNORECASE)
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")
_SHOWN = 40
# Bytes of a picture that lies beside a file.
_LARGEST_PICTURE = 1 << 28


@dataclass(frozen=True)
class Part:
    """A piece of the JSON with the place where it stands, for errors.

    Parameters
    ----------
    path : Path
        The file.
    place : str
        As in "nodes[3].rotation"; empty for the whole.
    value : object
        As `json` reads it.
    """

    path: Path
    place: str
    value: Any

    def error(self, expected: str, found: str = "") -> FormatError:
        """Return the error of something wrong here; what is found is the value by default."""
        text = repr(self.value)
        short = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
        where = f" at {self.place}" if self.place else ""
        return FormatError(f"expected {expected}, found {found or short}{where}", path=self.path)

    def has(self, key: str) -> bool:
        """Tell whether an object has a key.

        Raises
        ------
        FormatError
            If this is no object.
        """
        if not isinstance(self.value, dict):
            raise self.error("an object")
        return key in self.value

    def get(self, key: str, default: Any = None) -> Part:
        """Return what stands under a key, or the default.

        Raises
        ------
        FormatError
            If there is neither.
        """
        if not self.has(key) and default is None:
            raise self.error(f"an object with {key!r}", "none")
        place = f"{self.place}.{key}" if self.place else key
        return Part(self.path, place, self.value.get(key, default))

    def entries(self, key: str) -> list[Part]:
        """Return the entries of the list under a key; none where there is no list.

        Raises
        ------
        FormatError
            If it is something else.
        """
        listed = self.get(key, [])
        if not isinstance(listed.value, list):
            raise listed.error("a list")
        return [
            Part(self.path, f"{listed.place}[{number}]", value)
            for number, value in enumerate(listed.value)
        ]

    def whole(self, *, least: int = 0, most: int | None = None) -> int:
        """Return a whole number within limits, both allowed.

        Raises
        ------
        FormatError
            If this is something else.
        """
        value = self.value
        if type(value) is float and value.is_integer():
            value = int(value)
        if type(value) is not int or value < least or (most is not None and value > most):
            upper = "" if most is None else f" and at most {most}"
            raise self.error(f"a whole number of at least {least}{upper}")
        return value

    def numbers(self, count: int) -> Array:
        """Return so many finite numbers.

        Raises
        ------
        FormatError
            If this is something else.
        """
        expected = f"{count} numbers"
        listed = isinstance(self.value, list) and len(self.value) == count
        if not listed or any(type(x) not in (int, float) for x in self.value):
            raise self.error(expected)
        if any(not abs(x) <= LARGEST for x in self.value):
            raise self.error(f"{expected} of at most {LARGEST:g}")
        return np.array(self.value, float)

    def text(self) -> str:
        """Return a text.

        Raises
        ------
        FormatError
            If this is something else, or holds half of a pair of surrogates.
        """
        if not isinstance(self.value, str):
            raise self.error("text")
        try:
            self.value.encode()
        except UnicodeEncodeError:
            raise self.error("text that UTF-8 can hold") from None
        return self.value


@dataclass(frozen=True, eq=False)
class Document:
    """Hold the JSON of a file and the arrays that it speaks of.

    Parameters
    ----------
    root : Part
        The whole JSON.
    binary : bytes or None
        The binary chunk of a GLB.
    size : int
        Bytes of the file.
    """

    root: Part
    binary: bytes | None
    size: int
    _buffers: dict[int, memoryview] = field(default_factory=dict)

    @property
    def loaded(self) -> int:
        """Bytes of the file and of the buffers read so far."""
        return self.size + sum(len(buffer) for buffer in self._buffers.values())

    def entry(self, key: str, number: Part) -> Part:
        """Return an entry of a list at the top by its number.

        Raises
        ------
        FormatError
            If there is none of that number.
        """
        listed = self.root.get(key, [])
        if not isinstance(listed.value, list):
            raise listed.error("a list")
        if not listed.value:
            raise number.error(f"the number of an entry of {key}, of which there is none")
        chosen = number.whole(most=len(listed.value) - 1)
        return Part(listed.path, f"{key}[{chosen}]", listed.value[chosen])

    def accessor(self, number: Part, kind: str) -> Array:
        """Return the rows (count, width) of an accessor, whole numbers normalised if they are to.

        Parameters
        ----------
        number : Part
            That of the accessor.
        kind : str
            What its type must be, such as "VEC3".

        Raises
        ------
        FormatError
            If it is not sound, or does not lie within its buffer.
        """
        entry = self.entry("accessors", number)
        if entry.get("type").text() != kind:
            raise entry.get("type").error(f"an accessor of type {kind!r}")
        dtype, count = _dtype(entry), entry.get("count").whole(least=1)
        width = _WIDTHS[kind]
        if entry.has("bufferView"):
            rows = self._rows(entry, dtype, count, width)
        elif count <= self.loaded:
            rows = np.zeros((count, width), dtype)
        else:
            raise entry.get("count").error(f"a count of at most {self.loaded}")
        if entry.has("sparse"):
            rows = self._replaced(entry.get("sparse"), rows)
        return _as_numbers(entry, rows)

    def picture(self, image: Part) -> bytes:
        """Return what an image holds; nothing where its file is not there.

        Raises
        ------
        FormatError
            If it does not lie within its buffer.
        """
        if image.has("bufferView"):
            return bytes(self._view(self.entry("bufferViews", image.get("bufferView"))))
        uri = image.get("uri", "")
        embedded = _DATA_URI.match(uri.text())
        if embedded:
            return _decoded(uri, embedded, len(uri.value))
        try:
            return _beside(uri, _LARGEST_PICTURE)
        except FormatError:
            return b""

    def _rows(self, entry: Part, dtype: np.dtype[Any], count: int, width: int) -> NDArray[Any]:
        """Look at a buffer through an accessor, or the indices or values of a sparse one."""
        view = self.entry("bufferViews", entry.get("bufferView"))
        data = self._view(view)
        start, size = entry.get("byteOffset", 0).whole(), width * dtype.itemsize
        stride = size
        if view.has("byteStride"):
            stride = view.get("byteStride").whole(least=size)
        needed = start + stride * (count - 1) + size
        if needed > len(data):
            raise entry.error(f"rows within {len(data)} bytes", f"{count} that need {needed}")
        steps = (stride, dtype.itemsize)
        return np.ndarray((count, width), dtype, buffer=data, offset=start, strides=steps)

    def _replaced(self, sparse: Part, rows: NDArray[Any]) -> NDArray[Any]:
        """Put the values of a sparse accessor in their places."""
        count = sparse.get("count").whole(least=1, most=len(rows))
        indices, values = sparse.get("indices"), sparse.get("values")
        if indices.get("componentType").value not in (5121, 5123, 5125):
            raise indices.get("componentType").error("5121, 5123 or 5125")
        places = self._rows(indices, _dtype(indices), count, 1)[:, 0]
        if np.any(places >= len(rows)):
            raise indices.error(f"indices below {len(rows)}", str(places.max()))
        result = rows.copy()
        result[places] = self._rows(values, rows.dtype, count, rows.shape[1])
        return result

    def _view(self, view: Part) -> memoryview:
        """Return the bytes of a buffer view."""
        extensions = view.get("extensions", {})
        extensions.has("")  # an object, or FormatError
        packed = [name for name in extensions.value if "compression" in name]
        if packed:
            raise view.error("plain data", repr(packed[0]))
        number = view.get("buffer")
        buffer = self._buffer(self.entry("buffers", number), number.whole())
        start = view.get("byteOffset", 0).whole()
        stop = start + view.get("byteLength").whole(least=1)
        if stop > len(buffer):
            raise view.error(f"bytes within a buffer of {len(buffer)}", f"{start} to {stop}")
        return buffer[start:stop]

    def _buffer(self, buffer: Part, number: int) -> memoryview:
        if number not in self._buffers:
            length = buffer.get("byteLength").whole(least=1)
            data = self._content(buffer, length)
            if len(data) < length:
                raise buffer.error(f"{length} bytes", str(len(data)))
            self._buffers[number] = memoryview(data)[:length]
        return self._buffers[number]

    def _content(self, buffer: Part, length: int) -> bytes:
        if not buffer.has("uri"):
            if self.binary is None:
                raise buffer.error("a 'uri', or the binary chunk of a GLB", "neither")
            return self.binary
        uri = buffer.get("uri")
        embedded = _DATA_URI.match(uri.text())
        return _decoded(uri, embedded, length) if embedded else _beside(uri, length)


def _dtype(entry: Part) -> np.dtype[Any]:
    number = entry.get("componentType")
    if type(number.value) is not int or number.value not in _TYPES:
        raise number.error(f"a component type among {tuple(_TYPES)}")
    return np.dtype(_TYPES[number.value])


def _as_numbers(entry: Part, rows: NDArray[Any]) -> Array:
    with np.errstate(invalid="ignore"):  # NaN that signals
        values = rows.astype(float)
    if not np.all(np.abs(values) <= LARGEST):
        raise entry.error(f"finite numbers of at most {LARGEST:g}", "others")
    if entry.get("normalized", False).value is True and rows.dtype.kind in "iu":
        # The most negative number stands for -1, too (3.6.2.2).
        return np.maximum(values / np.iinfo(rows.dtype).max, -1.0)
    return values


def _decoded(uri: Part, head: re.Match[str], length: int) -> bytes:
    """Return so many bytes of a data URI, in base64 or with percent signs, or what there is."""
    if not head.group().lower().endswith(";base64,"):
        return unquote_to_bytes(uri.value[head.end() : head.end() + 3 * length])[:length]
    try:
        needed = -(-length // 3) * 4
        return base64.b64decode(uri.value[head.end() : head.end() + needed], validate=True)
    except ValueError as error:
        raise uri.error("base64", str(error)) from None


def _beside(uri: Part, length: int) -> bytes:
    """Read a file that lies in the folder of the glTF, or further down."""
    folder, name = uri.path.parent, unquote(uri.text())
    if _SCHEME.match(name) or name.startswith(("/", "\\")):
        raise uri.error("the name of a file in the same folder")
    try:
        home, place = folder.resolve(), (folder / name).resolve()
        if not place.is_relative_to(home):
            raise uri.error("the name of a file in the same folder")
        if not place.is_file():
            raise uri.error("the name of a file in the same folder", f"no file {name!r}")
        with place.open("rb") as content:
            return content.read(length)
    except (OSError, ValueError, RuntimeError) as error:
        raise uri.error("a file that can be read", str(error)) from None


def load(path: Path) -> Document:
    """Read a ``.glb`` or ``.gltf`` file; its first bytes tell which it is.

    Raises
    ------
    FormatError
        If it is neither, cut short, or not of version 2.
    OSError
        If it cannot be read.
    """
    raw = content(path)
    text, binary = _chunks(path, raw) if raw[:4] == _MAGIC else (raw, None)
    root = Part(path, "", _parsed(path, text))
    version = root.get("asset").get("version")
    if not version.text().startswith("2."):
        raise version.error("version 2.x")
    return Document(root, binary, len(raw))


def _chunks(path: Path, raw: bytes) -> tuple[bytes, bytes | None]:
    """Return the JSON of a GLB, and its binary chunk if there is one."""
    whole = Part(path, "", None)
    if len(raw) < 12:
        raise whole.error("a header of 12 bytes", str(len(raw)))
    _, version, length = struct.unpack_from("<4sII", raw)
    if version != 2:
        raise whole.error("GLB of version 2", str(version))
    if length > len(raw):
        raise whole.error(f"{length} bytes", str(len(raw)))
    kind, text, at = _chunk(whole, raw, 12)
    if kind != _JSON:
        raise whole.error("a JSON chunk first", f"one of type 0x{kind:08x}")
    if at >= length:
        return text, None
    kind, binary, _ = _chunk(whole, raw, at)
    return text, binary if kind == _BINARY else None


def _chunk(whole: Part, raw: bytes, at: int) -> tuple[int, bytes, int]:
    """Return type and content of a chunk, and where it ends."""
    if at + 8 > len(raw):
        raise whole.error("a chunk", f"the end at byte {len(raw)}")
    length, kind = struct.unpack_from("<II", raw, at)
    stop = at + 8 + length
    if stop > len(raw):
        raise whole.error(f"a chunk of {length} bytes at byte {at}", f"{len(raw) - at - 8}")
    return kind, raw[at + 8 : stop], stop


def _parsed(path: Path, text: bytes) -> Any:
    refuse: Callable[[str], NoReturn] = _no_number
    try:
        return json.loads(text.decode("utf-8-sig"), parse_constant=refuse)
    except RecursionError:
        raise FormatError("expected JSON, found lists within lists too deep", path=path) from None
    except json.JSONDecodeError as error:
        raise FormatError(
            f"expected JSON, found {error.msg}", path=path, line=error.lineno, column=error.colno
        ) from None
    except ValueError as error:
        raise FormatError(f"expected JSON, found {error}", path=path) from None


def _no_number(name: str) -> NoReturn:
    raise ValueError(f"{name} for a number")
