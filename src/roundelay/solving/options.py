"""What a user may choose where points become a skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roundelay.base.options import Checked, option

__all__ = ["SolvingOptions"]


@dataclass(frozen=True)
class SolvingOptions(Checked):
    """How markers and keypoints are written into formats of skeletons.

    Parameters
    ----------
    points : bool
        Whether they are written as joints that move, not as bones solved from them.
    """

    title: ClassVar[str] = "How markers and keypoints are written"

    points: bool = option(
        False, "Write markers and keypoints as joints that move, not as bones solved from them."
    )
