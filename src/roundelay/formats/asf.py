"""Read Acclaim skeleton files (ASF)."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np

from roundelay.base.errors import FormatError
from roundelay.formats import text
from roundelay.formats.acclaim import ROOT_DOF, AcclaimLayout, Bone, Vector
from roundelay.formats.sane import LARGEST
from roundelay.formats.text import Token
from roundelay.geometry.skeleton import Skeleton

__all__ = ["find_skeleton", "read_skeleton"]

Line = Sequence[Token]

_MAX_DEPTH = 256
_DOFS = {"rx", "ry", "rz", "tx", "ty", "tz", "lx", "ly", "lz", "l"}
_LIMIT = re.compile(r"\(\s*(\S+)\s+([^\s)]+)\s*\)")


def read_skeleton(path: Path) -> Skeleton:
    """Read an ASF file.

    Joints are in the order of a walk down the hierarchy, children as listed.

    Raises
    ------
    FormatError
        If the file is not a whole ASF, with line and column.
    """
    source = text.without_comments(text.load(path))
    return _Reader(text.Cursor(source)).read()


def find_skeleton(path: Path) -> Path:
    """Return the ASF that belongs to an AMC.

    The one whose name begins the AMC's (the longest such), in its folder or the one above;
    else the only one in its folder.

    Raises
    ------
    FormatError
        If there is none, saying where it was looked for.
    """
    here = _skeletons(path.parent)
    for folder in (here, _skeletons(path.parent.parent)):
        named = [asf for asf in folder if path.stem.lower().startswith(asf.stem.lower())]
        if named:
            return max(named, key=lambda asf: len(asf.stem))
    if len(here) == 1:
        return here[0]
    raise FormatError(
        f"expected its skeleton, an ASF whose name begins like {path.stem!r}, in "
        f"{path.parent} or {path.parent.parent}, or a single ASF in {path.parent}; "
        f"found {', '.join(asf.name for asf in here) or 'none'}",
        path=path,
    )


def _skeletons(folder: Path) -> list[Path]:
    return sorted(file for file in folder.iterdir() if file.suffix.lower() == ".asf")


@dataclass
class _Reader:
    """Read the sections of an ASF; `cursor` serves to check words and make errors."""

    cursor: text.Cursor
    units: dict[str, str] = field(default_factory=dict)
    heading: list[str] = field(default_factory=list)
    bones: dict[str, tuple[Bone, Token]] = field(default_factory=dict)
    children: dict[str, list[Token]] = field(default_factory=dict)
    position: Vector = (0.0, 0.0, 0.0)

    def read(self) -> Skeleton:
        readers: dict[str, Callable[[Token, list[Line]], None]] = {
            ":units": self._units,
            ":root": self._root,
            ":bonedata": self._bonedata,
            ":hierarchy": self._hierarchy,
        }
        sections = self._sections()
        for name in readers:
            if name not in sections and name != ":units":
                raise self._at_end(f"a section {name}")
        for name, (token, body) in sections.items():
            readers.get(name, self._heading)(token, body)
        return self._skeleton()

    def _sections(self) -> dict[str, tuple[Token, list[Line]]]:
        """Return each section's heading and lines, the heading's own line first."""
        sections: dict[str, tuple[Token, list[Line]]] = {}
        body: list[Line] | None = None
        for line in text.lines(self.cursor.source):
            if line[0].text.startswith(":"):
                if line[0].text.lower() in sections:
                    raise self.cursor.found("each section once", line[0])
                body = []
                sections[line[0].text.lower()] = line[0], body
                line = line[1:]
            if body is None:
                raise self.cursor.found("a section like :version or :root", line[0])
            if line:
                body.append(line)
        return sections

    def _heading(self, token: Token, body: list[Line]) -> None:
        self.heading.append(" ".join([token.text, *(word.text for word in (body or [[]])[0])]))
        self.heading.extend("   " + " ".join(word.text for word in line) for line in body[1:])

    def _units(self, token: Token, body: list[Line]) -> None:
        for line in body:
            self._count(line, 1)
            self.units[line[0].text.lower()] = line[1].text
            if line[0].text.lower() == "angle" and line[1].text.lower()[:3] not in ("deg", "rad"):
                raise self.cursor.found("deg or rad", line[1])

    def _root(self, token: Token, body: list[Line]) -> None:
        fields: dict[str, Any] = {"dof": ROOT_DOF}
        readers: dict[str, Callable[[Line], Any]] = {
            "order": lambda line: ("dof", self._dof(line)),
            "axis": lambda line: ("axis_order", self._axis_order(line, 1)),
            "orientation": lambda line: ("axis", self._vector(line)),
            "position": lambda line: ("position", self._vector(line)),
        }
        for line in body:
            reader = readers.get(line[0].text.lower())
            if reader is None:
                raise self.cursor.found("order, axis, position or orientation", line[0])
            name, value = reader(line)
            fields[name] = value
        self.position = fields.pop("position", self.position)
        self.bones["root"] = Bone("root", **fields), token

    def _bonedata(self, token: Token, body: list[Line]) -> None:
        block: list[Line] | None = None
        for line in body:
            word = line[0].text.lower()
            if block is None:
                if word != "begin":
                    raise self.cursor.found("begin", line[0])
                block = []
            elif word == "end":
                self._bone(block, line[0])
                block = None
            else:
                block.append(line)
        if block is not None:
            raise self._at_end("end of the bone")

    def _bone(self, block: list[Line], end: Token) -> None:
        fields: dict[str, Any] = {}
        name: Token | None = None
        for line in block:
            word = line[0].text.lower()
            if word == "name":
                self._count(line, 1)
                name = line[1]
            elif word == "limits" or word.startswith("("):
                limits = _LIMIT.findall(" ".join(token.text for token in line))
                fields["limits"] = fields.get("limits", ()) + tuple(limits)
            else:
                fields.update(self._bone_field(word, line))
        missing = [what for what in ("direction", "length") if what not in fields]
        if name is None or missing:
            raise self.cursor.found(f"{missing[0] if missing else 'name'} before the end", end)
        self._add(Bone(name.text, **fields), name)

    def _add(self, bone: Bone, name: Token) -> None:
        if bone.name in self.bones or bone.name == "root":
            raise self.cursor.found("a bone's name not used before", name)
        if not np.all(np.abs(bone.end) < LARGEST):
            raise self.cursor.found(f"a bone shorter than {LARGEST:g}", name)
        self.bones[bone.name] = bone, name

    def _bone_field(self, word: str, line: Line) -> dict[str, Any]:
        if word == "direction":
            return {"direction": self._vector(line)}
        if word == "length":
            self._count(line, 1)
            return {"length": self.cursor.as_number(line[1], "a length")}
        if word == "axis":
            self._count(line, 4)
            axis = self._vector(line[:4])
            return {"axis": axis, "axis_order": self._axis_order(line, 4)}
        if word == "dof":
            return {"dof": self._dof(line)}
        return {}

    def _dof(self, line: Line) -> tuple[str, ...]:
        found: list[str] = []
        for token in line[1:]:
            if token.text.lower() not in _DOFS - set(found):
                raise self.cursor.found("different channels among rx ry rz tx ty tz l", token)
            found.append(token.text.lower())
        return tuple(found)

    def _axis_order(self, line: Line, where: int) -> str:
        self._count(line, where)
        order = line[where].text.upper()
        if sorted(order) != ["X", "Y", "Z"]:
            raise self.cursor.found("an order of axes like XYZ", line[where])
        return order

    def _vector(self, line: Line) -> Vector:
        self._count(line, 3)
        values = [self.cursor.as_number(token, "a number") for token in line[1:]]
        return cast(Vector, tuple(values))

    def _count(self, line: Line, count: int) -> None:
        if len(line) != count + 1:
            found = len(line) - 1
            raise self.cursor.source.error(
                f"expected {count} values after {line[0].text}, found {found}", line[-1].at
            )

    def _hierarchy(self, token: Token, body: list[Line]) -> None:
        words = [line[0].text.lower() for line in body]
        if words[:1] != ["begin"]:
            raise self.cursor.found("begin after", token)
        if "end" not in words or len(body) != words.index("end") + 1:
            raise self._at_end("end of the hierarchy and nothing after it")
        parents = {"root"}
        for line in body[1:-1]:
            for name in line:
                if name.text not in self.bones:
                    raise self.cursor.found("a bone of :bonedata", name)
            for child in line[1:]:
                if child.text in parents:
                    raise self.cursor.found("one parent for each bone", child)
                parents.add(child.text)
            self.children.setdefault(line[0].text, []).extend(line[1:])

    def _skeleton(self) -> Skeleton:
        bones, parents = self._walk()
        offsets = [np.zeros(3)] + [bones[parent].end for parent in parents[1:]]
        with_children = set(parents)
        ends = tuple(
            (joint, bone.end)
            for joint, bone in enumerate(bones)
            if joint not in with_children and bone.length
        )
        units = tuple(self.units.items()) or AcclaimLayout.units
        layout = AcclaimLayout(tuple(bones), self.position, units, tuple(self.heading))
        names = tuple(bone.name for bone in bones)
        return Skeleton(names, tuple(parents), np.array(offsets), ends, layout)

    def _walk(self) -> tuple[list[Bone], list[int]]:
        """Return bones and parents in the order of the walk down from the root."""
        bones: list[Bone] = []
        parents: list[int] = []
        waiting = [("root", -1, 1)]
        while waiting:
            name, parent, depth = waiting.pop()
            if depth > _MAX_DEPTH:
                deep = self.bones[name][1]
                raise self.cursor.found(f"bones at most {_MAX_DEPTH} deep", deep)
            children = self.children.get(name, [])
            waiting.extend((child.text, len(bones), depth + 1) for child in reversed(children))
            bones.append(self.bones[name][0])
            parents.append(parent)
        if len(bones) < len(self.bones):
            placed = {bone.name for bone in bones}
            lost = next(token for name, (_, token) in self.bones.items() if name not in placed)
            raise self.cursor.found("each bone in :hierarchy below the root", lost)
        return bones, parents

    def _at_end(self, expected: str) -> FormatError:
        source = self.cursor.source
        return source.error(f"expected {expected}, found the end of the file", source.end)
