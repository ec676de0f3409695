"""Known sets of points: which points the trunk has, and which lines make them a body.

A set is known by its names: case, blanks, dots, dashes and a subject's prefix ("Anna:LASI") do
not count. Other sets are linked by what moves together; see `roundelay.motion.body`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["KNOWN_SETS", "PointSet", "known_set", "plain_name"]

# A set is taken for known if so many of its points are there, or half of them.
_KNOWN = 8


@dataclass(frozen=True)
class PointSet:
    """Describe a set of markers or keypoints.

    Parameters
    ----------
    name : str
        Of the set.
    trunk : tuple of str
        Points that hardly move against each other, plain names.
    chains : tuple of tuple of str
        Points from the trunk outward, each linked to the one before it that is there.
    """

    name: str
    trunk: tuple[str, ...]
    chains: tuple[tuple[str, ...], ...]

    @property
    def names(self) -> frozenset[str]:
        """Plain names of all points."""
        return frozenset(self.trunk).union(*self.chains)


def plain_name(name: str) -> str:
    """Return a name as sets list it: small letters and digits, without a subject's prefix."""
    return re.sub(r"[^a-z0-9]", "", name.rsplit(":", 1)[-1].lower())


def _sides(*chains: str) -> tuple[tuple[str, ...], ...]:
    """Return chains of both sides; ``*`` stands for the side's letter."""
    return tuple(
        tuple(name.replace("*", side) for name in chain.split())
        for chain in chains
        for side in ("l", "r")
    )


def _worded(*chains: str) -> tuple[tuple[str, ...], ...]:
    return tuple(
        tuple(name.replace("*", side) for name in chain.split())
        for chain in chains
        for side in ("left", "right")
    )


_PLUG_IN_GAIT = PointSet(
    "Plug-in Gait",
    ("lasi", "rasi", "lpsi", "rpsi", "sacr"),
    (
        ("sacr", "t10", "strn", "clav", "c7"),
        *_sides(
            "*asi *thi *kne *tib *ank *hee",
            "*ank *toe",
            "c7 *sho *upa *elb *frm *wra *fin",
            "*elb *fra *wra",
            "*elb *wrb",
            "c7 *bhd *fhd",
        ),
        ("t10", "rbak"),
        ("t10", "lbak"),
    ),
)
_HELEN_HAYES = PointSet(
    "Helen Hayes",
    ("rasis", "lasis", "vsacral"),
    (
        ("vsacral", "topofhead"),
        ("vsacral", "tophead", "fronthead"),
        ("tophead", "rearhead"),
        *_sides(
            "*asis *thigh *knee *shank *ankle *heel",
            "*ankle *toe",
            "*knee *kneemedial",
            "*ankle *anklemedial",
            "vsacral *shoulder *elbow *wrist",
        ),
    ),
)
_BODY_25 = PointSet(
    "OpenPose BODY_25",
    ("midhip", "lhip", "rhip", "neck"),
    (
        ("neck", "nose"),
        *_sides(
            "neck *shoulder *elbow *wrist",
            "*hip *knee *ankle *heel",
            "*ankle *bigtoe *smalltoe",
            "nose *eye *ear",
        ),
    ),
)
_COCO = PointSet(
    "COCO",
    ("lefthip", "righthip", "leftshoulder", "rightshoulder"),
    (
        ("leftshoulder", "nose"),
        *_worded("*shoulder *elbow *wrist", "*hip *knee *ankle", "nose *eye *ear"),
    ),
)
_MEDIAPIPE = PointSet(
    "MediaPipe 33",
    ("lefthip", "righthip", "leftshoulder", "rightshoulder"),
    (
        ("leftshoulder", "nose", "mouthleft"),
        ("nose", "mouthright"),
        *_worded(
            "*shoulder *elbow *wrist *index",
            "*wrist *thumb",
            "*wrist *pinky",
            "*hip *knee *ankle *heel",
            "*ankle *footindex",
            "nose *eyeinner *eye *eyeouter *ear",
        ),
    ),
)
KNOWN_SETS = (_PLUG_IN_GAIT, _HELEN_HAYES, _BODY_25, _MEDIAPIPE, _COCO)
"""The sets that are known; of several that fit, the one with most of the points is taken."""


def known_set(names: Sequence[str]) -> PointSet | None:
    """Return the known set that points belong to, by their names; None if none fits."""
    plain = {plain_name(name) for name in names}

    def fitting(one: PointSet) -> int:
        return len(plain & one.names)

    best = max(KNOWN_SETS, key=fitting)
    enough = fitting(best) >= min(_KNOWN, len(best.names) / 2)
    return best if enough and len(plain & set(best.trunk)) >= 2 else None
