"""Thresholds: every constant that decides a result, with its unit, origin and margin.

The constants of a room stand in its module `thresholds`, in one frozen record a concern::

    @dataclass(frozen=True)
    class _Closed(Thresholds):
        longest: float = constant(10.0, unit="seconds", origin=BY_EYE)

    CLOSED = _Closed()

Code reads ``CLOSED.longest`` when it runs and keeps no copy, so that `overridden` reaches it.
What the margins say was measured by ``python -m benchmarks.sensitivity``.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from importlib import import_module
from typing import Any

__all__ = ["BY_EYE", "Constant", "Thresholds", "Value", "constant", "constants", "overridden"]

Value = float | int | tuple[float, ...] | tuple[int, ...]

BY_EYE = "chosen by eye in the first version"
"""The origin of a constant that nobody measured."""


@dataclass(frozen=True)
class Constant:
    """One constant, as a table shows it.

    Attributes
    ----------
    name : str
        Room, record and field: "timeline.closed.longest".
    value : float, int or tuple
    unit : str
        What it is measured in.
    origin : str
        Where it is from: a document with its section, a measurement, or who chose it.
    margin : str
        What is known of how far it can be moved; empty where only the benchmark tells.
    record : Thresholds
        Where it stands.
    """

    name: str
    value: Value
    unit: str
    origin: str
    margin: str
    record: Thresholds

    @property
    def field(self) -> str:
        """Its name in the record."""
        return self.name.rpartition(".")[2]


@dataclass(frozen=True)
class Thresholds:
    """Base of the frozen records; every field is declared by `constant`."""


def constant(value: Value, *, unit: str, origin: str, margin: str = "") -> Any:
    """Declare a field of a record; the words are those of `Constant`."""
    return field(default=value, metadata={"unit": unit, "origin": origin, "margin": margin})


def constants() -> list[Constant]:
    """List the constants of all rooms, in the order in which they stand there."""
    package = import_module(__name__.partition(".")[0])
    found = []
    for room in pkgutil.iter_modules(package.__path__):
        if room.ispkg and room.name != "base":
            folder = import_module(f"{package.__name__}.{room.name}").__path__
            if "thresholds" in {module.name for module in pkgutil.iter_modules(folder)}:
                module = import_module(f"{package.__name__}.{room.name}.thresholds")
                found += list(_of_module(room.name, vars(module)))
    return found


def _of_module(room: str, names: dict[str, Any]) -> Iterator[Constant]:
    for name, record in names.items():
        if isinstance(record, Thresholds):
            for one in fields(record):
                path = f"{room}.{name.lower()}.{one.name}"
                yield Constant(path, getattr(record, one.name), record=record, **one.metadata)


@contextmanager
def overridden(one: Constant, value: Value) -> Iterator[None]:
    """Let a constant have another value for a while, in this process.

    For benchmarks and tests only: it holds for all threads.
    """
    before = getattr(one.record, one.field)
    object.__setattr__(one.record, one.field, value)
    try:
        yield
    finally:
        object.__setattr__(one.record, one.field, before)
