"""What a user may say of a capture that its file does not tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roundelay.base.options import Checked, option
from roundelay.motion.motion import FASTEST

__all__ = ["ReadOptions"]


@dataclass(frozen=True)
class ReadOptions(Checked):
    """What is said of a capture.

    Parameters
    ----------
    capture_fps : float, optional
        Its frames a second; what its file says by default.
    suffix : str, optional
        Its format, by a suffix without the dot; that of its name by default.
    fill_gaps : bool
        Whether gaps of points are filled as the rest of the body tells.
    max_gap : float, optional
        Longest gap that is filled so, in seconds; all that can be predicted by default.
    animation : str, optional
        Which of several animations; the first that moves the skeleton by default.
    character : str, optional
        Which of several skeletons, by the name of its root.
    salvage : bool
        Keep the whole frames of a recording that was cut off.
    encoding : str, optional
        That of names in a text file; found out by default.
    """

    title: ClassVar[str] = "What is said of a capture"

    capture_fps: float | None = option(
        None,
        "Frame rate of the capture, where its file tells none or a wrong one.",
        unit="frames a second",
        above=0,
        most=FASTEST,
    )
    suffix: str | None = option(
        None,
        "Format of the capture, where its name does not tell: {readers}.",
        flag="as",
        form="FORMAT",
    )
    fill_gaps: bool = option(
        True, "Fill gaps of markers and keypoints as the rest of the body tells."
    )
    max_gap: float | None = option(
        None,
        "Longest gap to fill; all that can be predicted by default.",
        unit="seconds",
        least=0,
    )
    animation: str | None = option(
        None,
        "Which of several animations is read, as `roundelay info` lists them; by default the first "
        "that moves the skeleton.",
    )
    character: str | None = option(
        None,
        "Which of several skeletons is read, by the name of its root, as `roundelay info` lists "
        "them.",
    )
    salvage: bool = option(
        False,
        "Keep the whole frames of a recording that was cut off; fill what is no number from the "
        "frames beside it.",
    )
    encoding: str | None = option(
        None,
        "Encoding of the names in a text, such as GBK or Shift-JIS; found out by default.",
    )
