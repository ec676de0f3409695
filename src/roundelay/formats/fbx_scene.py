"""An FBX scene: objects and what is connected to what, between the parts that describe them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from roundelay.base.version import __version__
from roundelay.formats.fbx_nodes import CREATED, FILE_ID, VERSION, Long, Node, Value, node

__all__ = ["Scene", "Take", "properties"]

_ROOT = Long(0)
_FIRST = 1_000_000
_CUSTOM_RATE = 14
# Axis and sign of up, of front (towards the viewer) and of right, where X, Y or Z points up.
_AXES = (
    ((0, 1), (2, 1), (1, -1)),
    ((1, 1), (2, 1), (0, 1)),
    ((2, 1), (1, -1), (0, 1)),
)


def properties(*rows: tuple[Value, ...]) -> Node:
    """Make a list of properties: name, type, label, flags and values of each."""
    return node("Properties70", inside=[node("P", *row) for row in rows])


@dataclass(frozen=True)
class Take:
    """Name the one take of a scene: how long it lasts in ticks, frames a second, the axis up."""

    name: str
    stop: Long
    fps: float
    up: int


class Scene:
    """Collect the objects of a scene and their connections."""

    def __init__(self) -> None:
        self._objects: list[Node] = []
        self._links: list[Node] = []

    def add(self, kind: str, subclass: str, name: str, *inside: Node) -> Long:
        """Add an object, such as a "Model" of the subclass "LimbNode"; return its identity."""
        identity = Long(_FIRST + len(self._objects))
        full = f"{name}\0\1{kind.replace('Animation', 'Anim')}"
        self._objects.append(node(kind, identity, full, subclass, inside=inside))
        return identity

    def connect(self, child: Long, parent: Long = _ROOT, of: str = "") -> None:
        """Connect an object to another, or to the scene; or to one of the other's properties."""
        values = (child, parent, of) if of else (child, parent)
        self._links.append(node("C", "OP" if of else "OO", *values))

    def nodes(self, take: Take) -> Iterator[Node]:
        """Yield what a file holds."""
        yield _header()
        yield node("FileId", FILE_ID)
        yield node("CreationTime", CREATED)
        yield node("Creator", _creator())
        yield _settings(take)
        yield _documents(take)
        yield node("References")
        yield self._definitions()
        yield node("Objects", inside=self._objects)
        yield node("Connections", inside=self._links)
        yield _takes(take)

    def _definitions(self) -> Node:
        """Count the objects of each kind; what they do not say has the format's defaults."""
        counts = Counter(["GlobalSettings", *(one.name for one in self._objects)])
        kinds = [
            node("ObjectType", kind, inside=[node("Count", count)])
            for kind, count in counts.items()
        ]
        total = node("Count", sum(counts.values()))
        return node("Definitions", inside=[node("Version", 100), total, *kinds])


def _creator() -> str:
    return f"roundelay {__version__}"


def _header() -> Node:
    day, hour = CREATED.split(" ")
    units = ("Year", "Month", "Day", "Hour", "Minute", "Second", "Millisecond")
    numbers = map(int, (*day.split("-"), *hour.split(":")))
    stamp = [node(unit, number) for unit, number in zip(units, numbers, strict=True)]
    return node(
        "FBXHeaderExtension",
        inside=[
            node("FBXHeaderVersion", 1003),
            node("FBXVersion", VERSION),
            node("EncryptionType", 0),
            node("CreationTimeStamp", inside=[node("Version", 1000), *stamp]),
            node("Creator", _creator()),
        ],
    )


def _settings(take: Take) -> Node:
    axes = zip(("Up", "Front", "Coord"), _AXES[take.up], strict=True)
    rows: list[tuple[Value, ...]] = []
    for which, (axis, sign) in axes:
        rows.append(_whole(f"{which}Axis", axis))
        rows.append(_whole(f"{which}AxisSign", sign))
    return node(
        "GlobalSettings",
        inside=[
            node("Version", 1000),
            properties(
                *rows,
                _whole("OriginalUpAxis", -1),
                _whole("OriginalUpAxisSign", 1),
                ("UnitScaleFactor", "double", "Number", "", 1.0),
                ("OriginalUnitScaleFactor", "double", "Number", "", 1.0),
                ("TimeMode", "enum", "", "", _CUSTOM_RATE),
                ("CustomFrameRate", "double", "Number", "", take.fps),
                ("TimeSpanStart", "KTime", "Time", "", Long(0)),
                ("TimeSpanStop", "KTime", "Time", "", take.stop),
            ),
        ],
    )


def _whole(name: str, value: int) -> tuple[Value, ...]:
    return (name, "int", "Integer", "", value)


def _documents(take: Take) -> Node:
    chosen = properties(("ActiveAnimStackName", "KString", "", "", take.name))
    document = node(
        "Document", Long(_FIRST - 1), "", "Scene", inside=[chosen, node("RootNode", _ROOT)]
    )
    return node("Documents", inside=[node("Count", 1), document])


def _takes(take: Take) -> Node:
    """List the take once more, where older readers look for it."""
    span = (Long(0), take.stop)
    inside = [
        node("FileName", f"{take.name}.tak"),
        node("LocalTime", *span),
        node("ReferenceTime", *span),
    ]
    return node(
        "Takes", inside=[node("Current", take.name), node("Take", take.name, inside=inside)]
    )
