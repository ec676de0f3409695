"""What a user may choose of a segmentation: the method, and the options of the default one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from roundelay.base.options import Checked, option
from roundelay.segmentation.behaviours import BehaviourOptions
from roundelay.segmentation.cutting import checked_method
from roundelay.segmentation.gmm import GMMOptions
from roundelay.segmentation.pca import PCAOptions
from roundelay.segmentation.ppca import PPCAOptions

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
    pca, ppca, gmm : PCAOptions, PPCAOptions, GMMOptions
        Those of the methods of [B]. Names that end in ``-paper`` have all of the paper's.

    Raises
    ------
    ValueError
        If options of one method are given for another.
    """

    title: ClassVar[str] = "Where behaviours change"

    method: str = option("behaviours", "How cuts are found: {methods}.", flag="cut-by")
    default: BehaviourOptions = option(BehaviourOptions, "The default method.")
    pca: PCAOptions = option(PCAOptions, "The method pca.")
    ppca: PPCAOptions = option(PPCAOptions, "The method ppca.")
    gmm: GMMOptions = option(GMMOptions, "The method gmm.")

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_method(self.method)
        for name, given in self._own.items():
            if self.method != name and given != type(given)():
                raise ValueError(
                    f"expected options of the method {name!r} with that method, "
                    f"found {self.method!r}"
                )

    @property
    def _own(self) -> dict[str, Any]:
        """The options by the names of their methods."""
        return {"behaviours": self.default, "pca": self.pca, "ppca": self.ppca, "gmm": self.gmm}

    @property
    def chosen(self) -> Any:
        """What `roundelay.segment` takes for its method."""
        return self._own.get(self.method, self.method)
