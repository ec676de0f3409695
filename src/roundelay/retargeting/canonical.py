"""The canonical body: the joints that all bodies of a kind have, and what they hang on.

A biped has 22, as SMPL; a quadruped has a tail of two more. The front legs of a quadruped are its
arms: the same bones, by anatomy.
"""

from __future__ import annotations

from typing import Literal

__all__ = ["ARM", "JOINTS", "LEG", "NEEDED", "SIDES", "SPINE", "TAIL", "TREE", "Kind", "joints_of"]

Kind = Literal["biped", "quadruped"]

SIDES = ("left", "right")
SPINE = ("spine", "chest", "upper chest")
TAIL = ("tail", "tail tip")
ARM = ("shoulder", "upper arm", "lower arm", "hand")
LEG = ("upper leg", "lower leg", "foot", "toes")


def _tree() -> dict[str, str | None]:
    tree: dict[str, str | None] = {"hips": None, "spine": "hips", "chest": "spine"}
    tree |= {"upper chest": "chest", "neck": "upper chest", "head": "neck"}
    for side in SIDES:
        for limb, top in ((ARM, "upper chest"), (LEG, "hips")):
            for above, name in zip((top, *(f"{side} {one}" for one in limb)), limb, strict=False):
                tree[f"{side} {name}"] = above
    return tree | {"tail": "hips", "tail tip": "tail"}


TREE = _tree()
"""What each joint hangs on."""
JOINTS = tuple(TREE)
"""All joints of the canonical body; a biped has no tail."""
NEEDED = tuple(
    f"{side} {part}"
    for side in SIDES
    for part in ("upper arm", "lower arm", "upper leg", "lower leg", "foot")
)
"""What a body must have, besides its hips and its head."""


def joints_of(kind: Kind) -> tuple[str, ...]:
    """Return the joints of the canonical body of a kind, parents first."""
    return JOINTS if kind == "quadruped" else JOINTS[: -len(TAIL)]
