"""Registries: formats, methods and models by name, ours and those of plug-ins.

What roundelay brings is added in code, since Blender has no package metadata. A plug-in names an
object in the entry points of its own package::

    [project.entry-points."roundelay.readers"]
    tracker = "my_package:TrackerReader"

The object is an instance with a `name`, or a class that makes one without arguments.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from importlib.metadata import EntryPoint, entry_points
from typing import Generic, Protocol, TypeVar

from roundelay.base.errors import RoundelayWarning

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
        What each must be: a runtime-checkable Protocol.
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
            If it lacks a method of the protocol.
        ValueError
            If its name is taken.
        """
        self._check(item)
        if item.name in self._own:
            raise ValueError(f"expected a new name for a {self.kind}, found {item.name!r}")
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
        yield from (item for name, item in self._plugged().items() if name not in self._own)

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

    def _check(self, item: object) -> None:
        if not isinstance(item, self.protocol):
            lacking = [x for x in _members(self.protocol) if not hasattr(item, x)]
            raise TypeError(f"expected a {self.kind} with {', '.join(lacking)}, found {item!r}")

    def _plugged(self) -> dict[str, Item]:
        """Load the plug-ins when first asked; one that fails costs a warning, not the program."""
        if self._brought is None:
            self._brought = {}
            for point in entry_points(group=self.group):
                try:
                    item = self._loaded(point)
                except Exception as error:
                    text = f"{self.kind} {point.name!r} of {point.value} cannot be used: {error}"
                    warnings.warn(text, RoundelayWarning, stacklevel=2)
                else:
                    self._brought.setdefault(item.name, item)
        return self._brought

    def _loaded(self, point: EntryPoint) -> Item:
        loaded = point.load()
        item: Item = loaded() if isinstance(loaded, type) else loaded
        self._check(item)
        return item


def _members(protocol: type) -> list[str]:
    """List the public attributes that a protocol asks for."""
    asked = [(*vars(base), *vars(base).get("__annotations__", ())) for base in protocol.__mro__]
    return sorted({name for names in asked for name in names if not name.startswith("_")})
