"""What a user may choose of a segmentation: the method, and the options of the default one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roundelay.base.options import Checked, option
from roundelay.segmentation.cutting import checked_method
from roundelay.segmentation.gaussian import GaussianOptions

__all__ = ["SegmentOptions"]


@dataclass(frozen=True)
class SegmentOptions(Checked):
    """Choices of how a capture is cut into behaviours.

    Parameters
    ----------
    method : str
        The method's name, as `roundelay.segment` takes it.
    gaussian : GaussianOptions
        The options of the default method.

    Raises
    ------
    ValueError
        If options of the default method are given for another.
    """

    title: ClassVar[str] = "Where behaviours change"

    method: str = option("gaussian", "How cuts are found: {methods}.", flag="cut-by")
    gaussian: GaussianOptions = option(GaussianOptions, "The default method.")

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_method(self.method)
        if self.method != "gaussian" and self.gaussian != GaussianOptions():
            raise ValueError(
                f"expected options of the method 'gaussian' with that method, found {self.method!r}"
            )

    @property
    def chosen(self) -> str | GaussianOptions:
        """What `roundelay.segment` takes for its method."""
        return self.gaussian if self.method == "gaussian" else self.method
