"""Registries: formats, methods and models by name, ours and those of plug-ins.

What roundelay brings is added in code, since Blender has no package metadata. A plug-in names an
object in the entry points of its own package::

    [project.entry-points."roundelay.readers"]
    tracker = "my_package:TrackerReader"

The object is an instance with a `name`, or a class that makes one without arguments. Entry points
are looked up once, when something is asked for that roundelay does not bring itself.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from roundelay.base.errors import RoundelayWarning

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["Named", "Registry"]


class Named(Protocol):
    """Whatever bears a name."""

    @property
    def name(self) -> str:
        """How it is asked for."""
        ...


Item = TypeVar("Item", bound=Named)


class Registry(Generic[Item]):
    """Hold the objects of one kind by name, in the order in which they were added.

    Parameters
    ----------
    kind : str
        One of them in words, for errors: "reader", "cycle model".
    group : str
        The group of entry points by which plug-ins bring further ones; these come last.
    protocol : type
        What each must be: a Protocol.
    """

    def __init__(self, kind: str, group: str, protocol: type) -> None:
        self.kind, self.group, self.protocol = kind, group, protocol
        self._own: dict[str, Item] = {}
        self._brought: dict[str, Item] | None = None

    def add(self, item: Item) -> Item:
        """Add an object, and return it.

        Raises
        ------
        TypeError
            If it lacks a name or a method of the protocol.
        ValueError
            If its name is taken.
        """
        self._check(item, self._own | (self._brought or {}))
        self._own[item.name] = item
        return item

    def remove(self, name: str) -> None:
        """Take off what `add` added.

        Raises
        ------
        KeyError
            If nothing was added by that name.
        """
        del self._own[name]

    def __iter__(self) -> Iterator[Item]:
        yield from self._own.values()
        yield from self._plugged().values()

    def names(self) -> tuple[str, ...]:
        """Return all names."""
        return tuple(item.name for item in self)

    def __getitem__(self, name: str) -> Item:
        """Return the object of a name.

        Raises
        ------
        ValueError
            If there is none; the message lists the names.
        """
        for item in self:
            if item.name == name:
                return item
        raise ValueError(f"expected a {self.kind} among {self.names()}, found {name!r}")

    def _check(self, item: Any, taken: dict[str, Item]) -> None:
        """Refuse what lacks a part of the protocol, or bears no name or one that is taken."""
        lacking = [name for name in _members(self.protocol) if getattr(item, name, None) is None]
        if lacking:
            raise TypeError(f"expected a {self.kind} with {', '.join(lacking)}, found {item!r}")
        if not (isinstance(item.name, str) and item.name):
            raise TypeError(f"expected text as the name of a {self.kind}, found {item.name!r}")
        if item.name in taken:
            raise ValueError(f"expected a new name for a {self.kind}, found {item.name!r}")

    def _plugged(self) -> dict[str, Item]:
        """Load the plug-ins when first asked; one that fails costs a warning, not the program."""
        if self._brought is None:
            brought: dict[str, Item] = {}
            faults = []
            for point in _entry_points().select(group=self.group):
                try:
                    item = self._loaded(point, self._own | brought)
                # SystemExit: some modules end the program where they cannot be used.
                except (Exception, SystemExit) as error:
                    faults.append(f"{self.kind} {point.name!r} of {point.value}: {error}")
                else:
                    brought[item.name] = item
            self._brought = brought
            for fault in faults:
                warnings.warn(f"a plug-in cannot be used: {fault}", RoundelayWarning, stacklevel=3)
        return self._brought

    def _loaded(self, point: EntryPoint, taken: dict[str, Item]) -> Item:
        loaded = point.load()
        item: Item = loaded() if isinstance(loaded, type) else loaded
        self._check(item, taken)
        return item


@cache
def _entry_points() -> Any:
    """Look up the entry points of all packages, once: it takes time, as does the import."""
    from importlib.metadata import entry_points

    return entry_points()


def _members(protocol: type) -> list[str]:
    """List the public attributes that a protocol asks for."""
    asked = [(*vars(base), *vars(base).get("__annotations__", ())) for base in protocol.__mro__]
    return sorted({name for names in asked for name in names if not name.startswith("_")})
