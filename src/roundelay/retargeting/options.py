"""What a user may choose of carrying motions to a character."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roundelay.base.options import Checked, option

__all__ = ["OntoOptions"]


@dataclass(frozen=True)
class OntoOptions(Checked):
    """Choices of the character that a motion is carried to.

    Parameters
    ----------
    onto : str, optional
        The file of the character: any that is read, such as FBX, GLB or VRM, with an animation or
        without; none by default.
    onto_root : str, optional
        Which of several skeletons in it, by the name of its root.
    map : str, optional
        A file that tells which joints are which; what is found is written there if it is not.
    """

    title: ClassVar[str] = "On which character"

    onto: str | None = option(
        None,
        "Carry what is read to the character of this file, an FBX, GLB, VRM or any capture.",
        form="FILE",
    )
    onto_root: str | None = option(
        None, "Which of several skeletons of the character's file, by the name of its root."
    )
    map: str | None = option(
        None,
        "Which joints are which of the canonical body; what is found is written there if there is "
        "no such file, to be edited.",
        form="FILE",
    )
