"""What stands in an FBX file: its objects, what is connected to what, and its settings.

Format: none is published; what is read here agrees with files of Autodesk's programs, Blender and
Mixamo, and with what Blender and ufbx make of them. Files before version 7 name objects where later
ones number them, and keep curves in their takes.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from roundelay.base.errors import FormatError
from roundelay.base.files import content
from roundelay.formats.fbx_binary import MAGIC, elements_of_binary
from roundelay.formats.fbx_elements import Element
from roundelay.formats.fbx_text import elements_of_text, is_text

__all__ = ["Fbx", "Object", "Properties", "load"]

_FIRST_NUMBERED = 7000
# Ticks a second, of files and of those that say that they are of the newer definition.
_TICKS, _NEW_TICKS, _NEW_DEFINITION, _NEW_VERSION = 46_186_158_000, 141_120_000, 127, 8000
# Frames a second by the number of the time mode; 0 tells none, 14 a rate of its own.
_RATES = {
    1: 120.0,
    2: 100.0,
    3: 60.0,
    4: 50.0,
    5: 48.0,
    6: 30.0,
    7: 30.0,
    8: 30.0 / 1.001,
    9: 30.0 / 1.001,
    10: 25.0,
    11: 24.0,
    12: 1000.0,
    13: 24.0 / 1.001,
    15: 96.0,
    16: 72.0,
    17: 60.0 / 1.001,
    18: 120.0 / 1.001,
}
_CUSTOM = 14
_FASTEST = 10_000.0


@dataclass(frozen=True)
class Properties:
    """Look up properties of an object: its own, then those its kind has by default."""

    rows: dict[str, tuple[Element, int]]
    template: dict[str, tuple[Element, int]] = field(default_factory=dict)

    @classmethod
    def of(cls, one: Element | None, template: Properties | None = None) -> Properties:
        """Read the properties inside an element."""
        rows: dict[str, tuple[Element, int]] = {}
        for listed, entry, first in (("Properties70", "P", 4), ("Properties60", "Property", 3)):
            held = None if one is None else one.first(listed)
            for row in () if held is None else held.all(entry):
                rows[row.text(0)] = (row, first)
        return cls(rows, {} if template is None else template.rows)

    def _row(self, name: str) -> tuple[Element, int] | None:
        return self.rows.get(name) or self.template.get(name)

    def number(self, name: str, default: float) -> float:
        """Return a number; the default where there is none.

        Raises
        ------
        FormatError
            If the property is no finite number.
        """
        row = self._row(name)
        if row is None or len(row[0].values) <= row[1]:
            return default
        return float(row[0].numbers(row[1], 1)[0])

    def whole(self, name: str, default: int) -> int:
        """Return a whole number; the default where there is none.

        Raises
        ------
        FormatError
            If the property is something else.
        """
        row = self._row(name)
        if row is None or len(row[0].values) <= row[1]:
            return default
        return row[0].whole(row[1])

    def vector(self, name: str, default: float = 0.0) -> list[float]:
        """Return three numbers.

        Raises
        ------
        FormatError
            If the property is something else.
        """
        row = self._row(name)
        if row is None or len(row[0].values) <= row[1]:
            return [default] * 3
        return [float(x) for x in row[0].numbers(row[1], 3)]

    def text(self, name: str) -> str:
        """Return a text; an empty one where there is none."""
        row = self._row(name)
        return "" if row is None else row[0].text(row[1], "")


@dataclass(frozen=True)
class Object:
    """An object: its identity, what kind of it, and its name.

    Parameters
    ----------
    identity : hashable
        A number, or the whole name in files before version 7.
    kind : str
        As in "Model".
    name : str
    subclass : str
        As in "LimbNode".
    element : Element
    """

    identity: Hashable
    kind: str
    name: str
    subclass: str
    element: Element


@dataclass(frozen=True, eq=False)
class Fbx:
    """Hold a file.

    Parameters
    ----------
    path : Path
    size : int
        Bytes.
    version : int
        As in 7400.
    root : Element
        Holds all others.
    objects : dict of Object
        By their identity.
    links : list of (child, parent, property)
        Identities; the property is empty where an object is connected as a whole.
    """

    path: Path
    size: int
    version: int
    root: Element
    objects: dict[Hashable, Object]
    links: list[tuple[Hashable, Hashable, str]]
    _children: dict[Hashable, list[tuple[Object, str]]] = field(default_factory=dict)

    def error(self, expected: str, found: str) -> FormatError:
        """Return an error of the file as a whole."""
        return FormatError(f"expected {expected}, found {found}", path=self.path)

    def below(self, one: Hashable, kind: str = "") -> Iterator[tuple[Object, str]]:
        """Yield what is connected to an object, of a kind, and to which of its properties."""
        if not self._children:
            for child, parent, of in self.links:
                if child in self.objects:
                    held = self._children.setdefault(parent, [])
                    held.append((self.objects[child], of))
        return (pair for pair in self._children.get(one, ()) if not kind or pair[0].kind == kind)

    def of_kind(self, kind: str) -> list[Object]:
        """List the objects of a kind."""
        return [one for one in self.objects.values() if one.kind == kind]

    @property
    def settings(self) -> Properties:
        """What is set for the whole scene."""
        settings = self.root.first("GlobalSettings")
        return Properties.of(settings or self.root.within("Objects", "GlobalSettings"))

    def template(self, kind: str) -> Properties:
        """Return the properties that objects of a kind have by default."""
        definitions = self.root.first("Definitions")
        for one in () if definitions is None else definitions.all("ObjectType"):
            if one.text(0, "") == kind:
                return Properties.of(one.first("PropertyTemplate"))
        return Properties({})

    @property
    def ticks(self) -> float:
        """Ticks of a second."""
        header = self.root.within("FBXHeaderExtension", "OtherFlags", "TCDefinition")
        new = header is not None and header.whole(0, 0) == _NEW_DEFINITION
        return float(_NEW_TICKS if new or self.version >= _NEW_VERSION else _TICKS)

    @property
    def rate(self) -> float | None:
        """Frames a second that the file tells, if it does."""
        mode = self.settings.whole("TimeMode", 0)
        if mode == _CUSTOM:
            rate = self.settings.number("CustomFrameRate", 0.0)
            return rate if 0.0 < rate <= _FASTEST else None
        if mode == 0:
            told = self.root.within("Version5", "Settings", "FrameRate")
            return None if told is None else _RATES.get(_mode_of(told.values))
        return _RATES.get(mode)


def _mode_of(values: tuple[Any, ...]) -> int:
    """Return the time mode of a rate that is told as a text, as in "30"."""
    known = {f"{rate:g}": mode for mode, rate in reversed(_RATES.items())}
    return known.get(str(values[0]) if values else "", 0)


def load(path: Path) -> Fbx:
    """Read an FBX file, binary or text; its first bytes tell which it is.

    Raises
    ------
    FormatError
        If it is neither, cut short, encrypted, or not sound.
    OSError
        If it cannot be read.
    """
    data = content(path)
    if data.startswith(MAGIC):
        version, root = elements_of_binary(path, data)
    elif is_text(data):
        version, root = elements_of_text(path, data)
    else:
        raise FormatError(f"expected an FBX file, found {data[:12]!r} at its start", path=path)
    hidden = root.within("FBXHeaderExtension", "EncryptionType")
    if hidden is not None and hidden.whole(0, 0):
        raise hidden.error("a file that is not encrypted", "an encrypted one; export it without")
    objects = {one.identity: one for one in _objects(root, version)}
    if not objects:
        raise FormatError("expected objects, found none", path=path)
    return Fbx(path, len(data), version, root, objects, list(_links(root)))


def _objects(root: Element, version: int) -> Iterator[Object]:
    listed = root.first("Objects")
    for one in () if listed is None else listed.inside:
        if version >= _FIRST_NUMBERED:
            if len(one.values) >= 3:
                name = _short(one.text(1, ""))
                yield Object(one.whole(0), one.name, name, one.text(2, ""), one)
        elif one.values and isinstance(one.values[0], str):
            full = _normal(one.values[0])
            yield Object(full, one.name, _short(full), one.text(1, ""), one)


def _normal(name: str) -> str:
    """Return a name with its class as text has it: "Model::Hips"."""
    own, mark, kind = name.partition("\0\1")
    return f"{kind}::{own}" if mark else name


def _short(name: str) -> str:
    """Return the name without its class."""
    own, mark, _ = name.partition("\0\1")
    return own if mark else name.partition("::")[2] or name


def _links(root: Element) -> Iterator[tuple[Hashable, Hashable, str]]:
    listed = root.first("Connections")
    for one in () if listed is None else listed.inside:
        if len(one.values) < 3 or one.values[0] not in ("OO", "OP"):
            continue
        child, parent = (_normal(x) if isinstance(x, str) else x for x in one.values[1:3])
        if isinstance(child, int | str) and isinstance(parent, int | str):
            yield child, parent, one.text(3, "") if one.values[0] == "OP" else ""
