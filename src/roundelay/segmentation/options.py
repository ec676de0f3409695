"""What a user may choose of a segmentation: the method, and the options of the default one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roundelay.base.options import Checked, option
from roundelay.segmentation.behaviours import BehaviourOptions
from roundelay.segmentation.cutting import checked_method

__all__ = ["SegmentOptions"]


@dataclass(frozen=True)
class SegmentOptions(Checked):
    """Choices of how a capture is cut into behaviours.

    Parameters
    ----------
    method : str
        The method's name, as `roundelay.segment` takes it.
    default : BehaviourOptions
        The options of the default method.

    Raises
    ------
    ValueError
        If options of the default method are given for another.
    """

    title: ClassVar[str] = "Where behaviours change"

    method: str = option("behaviours", "How cuts are found: {methods}.", flag="cut-by")
    default: BehaviourOptions = option(BehaviourOptions, "The default method.")

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_method(self.method)
        if self.method != "behaviours" and self.default != BehaviourOptions():
            raise ValueError(
                "expected options of the method 'behaviours' with that method, "
                f"found {self.method!r}"
            )

    @property
    def chosen(self) -> str | BehaviourOptions:
        """What `roundelay.segment` takes for its method."""
        return self.default if self.method == "behaviours" else self.method
