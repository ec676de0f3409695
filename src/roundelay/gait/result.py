"""What is told of the gait of a take: moments of steps, strides, their spread, left and right."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, fields
from math import isfinite
from typing import Any

from roundelay.base.spans import Spans
from roundelay.gait.events import StepEvent
from roundelay.gait.options import Rule
from roundelay.gait.spread import Spread
from roundelay.gait.table import QUANTITIES, Stride

__all__ = ["Difference", "Strides"]


@dataclass(frozen=True)
class Difference:
    """A quantity of the left foot against that of the right one.

    Attributes
    ----------
    left, right : str
        Names of the feet.
    difference : float
        Mean of the left minus that of the right.
    low, high : float
        Interval of the difference.
    share : float
        The difference over the mean of both.
    """

    left: str
    right: str
    difference: float
    low: float
    high: float
    share: float


@dataclass(frozen=True, eq=False)
class Strides:
    """Steps and strides of a take.

    Attributes
    ----------
    events : tuple of StepEvent
        Moments of all steps, in order of time.
    strides : tuple of Stride
        In order of time.
    summary : dict
        A `Spread` a quantity, by the name of the foot and of the quantity.
    differences : dict
        A list of `Difference` a quantity: of each pair of feet.
    spans : Spans
        The frames that were looked at.
    rule : {"velocity", "zeni", "contacts"}
        How moments were told.
    ground : {"still", "belt"}
        What they walk on: a belt is a treadmill's, or a take that stays in place.
    backward : bool
        Whether the body goes where its back is.
    unit : {"m", ""}
        Of lengths; the file's where it is not known.
    notes : tuple of str
        What is missing, and why.
    level : float
        Of the intervals.
    fps : float
    name : str
        Of the take.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> found = rl.strides(walk)
    >>> len(found.strides), found.unit
    (11, 'm')
    """

    events: tuple[StepEvent, ...]
    strides: tuple[Stride, ...]
    summary: dict[str, dict[str, Spread]]
    differences: dict[str, list[Difference]]
    spans: Spans
    rule: Rule
    ground: str
    backward: bool
    unit: str
    notes: tuple[str, ...]
    level: float = field(repr=False)
    fps: float = field(repr=False)
    name: str = ""

    def __repr__(self) -> str:
        told = f"{len(self.events)} moments, {len(self.strides)} strides, by {self.rule}"
        return f"Strides({self.name!r}, {told})"

    @property
    def feet(self) -> tuple[str, ...]:
        """Names of the feet."""
        return tuple(self.summary)

    def times(self, foot: str, kind: str) -> list[float]:
        """Return the seconds of the take at which a foot strikes or leaves ("strike", "off")."""
        found = (one for one in self.events if (one.foot, one.kind) == (foot, kind))
        return [one.frame / self.fps for one in found]

    def unit_of(self, quantity: str) -> str:
        """Return the unit of a quantity, empty for a share."""
        unit = QUANTITIES[quantity]
        return unit if self.unit == "m" else unit.replace("m", "units", unit in ("m", "m/s"))

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain data; a figure that is not known is None."""
        return {
            "rule": self.rule,
            "ground": self.ground,
            "backward": self.backward,
            "unit": self.unit or None,
            "level": self.level,
            "spans": [list(span) for span in self.spans],
            "notes": list(self.notes),
            "events": [
                {"foot": x.foot, "kind": x.kind, "frame": x.frame, "seconds": x.frame / self.fps}
                for x in self.events
            ],
            "strides": [_plain(stride) for stride in self.strides],
            "summary": {
                foot: {name: _plain(spread) for name, spread in told.items()}
                for foot, told in self.summary.items()
            },
            "differences": {
                name: [_plain(one) for one in told] for name, told in self.differences.items()
            },
        }

    def to_csv(self) -> str:
        """Return a table: a row a stride; what is not known is empty."""
        names = [one.name for one in fields(Stride)]
        rows = (_cells(asdict(stride).values()) for stride in self.strides)
        return "\n".join([",".join(names), *rows, ""])


def _plain(one: Any) -> dict[str, Any]:
    return {
        name: None if isinstance(value, float) and not isfinite(value) else value
        for name, value in asdict(one).items()
    }


def _cells(values: Iterable[Any]) -> str:
    return ",".join(
        value if isinstance(value, str) else f"{value:.5f}" if isfinite(value) else ""
        for value in values
    )
