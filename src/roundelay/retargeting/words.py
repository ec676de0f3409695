"""What the names of joints say: which part of a body, and on which side.

Names are taken apart into words (``DEF-upper_arm.L.001``: upper, arm). What many programs call
their joints is one list of patterns; some names mean two things (a shoulder may be a collar bone
or an upper arm), so that a name has weights.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from roundelay.geometry.symmetry import is_left, other_side

__all__ = ["Word", "words_of"]

Side = Literal["left", "right"]

_WORDS = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")
_LEFT, _RIGHT = {"left", "l"}, {"right", "r"}
# Words that say nothing of the part.
_EMPTY = re.compile(
    r"def|org|mch|bip|bip\d*|bone|jnt|joint|jt|cc|base|valve|biped|mixamorig\d*|bind|sk|j|c|b|rig|m"
)
# What hangs on a body or serves it, and is no part of it.
_ODD = {
    *("twist", "roll", "ik", "fk", "pole", "target", "ctrl", "control", "helper", "end", "nub"),
    *("site", "socket", "weapon", "prop", "attach", "eye", "eyes", "jaw", "tongue", "teeth", "lid"),
    *("brow", "lip", "cheek", "breast", "bust", "hair", "skirt", "cloth", "cape", "ear", "muscle"),
    *("bulge", "nose", "chin", "face", "forehead", "temple", "share", "corrective", "top"),
    *("finger", "fingers", "thumb", "index", "middle", "mid", "ring", "pinky", "pinkie", "little"),
    *("palm", "metacarpal", "carpal", "simulation"),
}
_LIMBS: tuple[tuple[str, dict[str, float]], ...] = (
    ("clav|collar|scapula", {"shoulder": 3}),
    ("upper_?arm|uparm|uarm|humerus|shldr|bicep|armup", {"upper arm": 3}),
    ("forearm|lowerarm|lowarm|loarm|^farm|radius|ulna|elbow|armlow", {"lower arm": 3}),
    ("shoulder", {"shoulder": 2, "upper arm": 2}),
    ("arm", {"upper arm": 2, "lower arm": 0.5}),
    ("wrist", {"hand": 4}),
    ("hand", {"hand": 3}),
    ("hipjoint|buttock|pelvis", {}),
    ("upperleg|upleg|uleg|thigh|femur|legup", {"upper leg": 3}),
    ("lowerleg|lowleg|loleg|shin|calf|tibia|knee|crus|leglow", {"lower leg": 3}),
    ("hip", {"upper leg": 2.5}),
    ("leg", {"lower leg": 2, "upper leg": 1.5}),
    ("ankle", {"foot": 3}),
    ("toe|ball", {"toes": 3}),
    ("foot|paw|hoof", {"foot": 2.5, "toes": 1}),
)
_MIDDLE: tuple[tuple[str, dict[str, float]], ...] = (
    ("head|skull", {"head": 3}),
    ("neck", {"neck": 3}),
    ("tail", {"tail": 3}),
    ("spine|chest|thorax|abdomen|^abs?$|back|waist|torso", {"spine": 3}),
    ("hip|pelvis|root|cog", {"hips": 3}),
)
# A front leg is an arm, by its bones.
_HELPER = re.compile("twist|nub|dummy")
_FORE = re.compile("front|fore_?(leg|foot|paw|thigh|hoof|limb)")
_FRONT = {"upper leg": "upper arm", "lower leg": "lower arm", "foot": "hand"}


@dataclass(frozen=True)
class Word:
    """What a name says.

    Attributes
    ----------
    side : {"left", "right"} or None
    weights : dict of str to float
        Parts that it may be, as canonical joints are called without their side; the larger the
        surer. None for what is odd.
    odd : bool
        Whether it names a helper, a twist, a finger or the like.
    front : bool
        Whether it names a front leg.
    told : str
        The words, without side and number.
    """

    side: Side | None
    weights: dict[str, float]
    odd: bool
    front: bool = False
    told: str = ""


def words_of(names: Sequence[str]) -> list[Word]:
    """Tell what each of a skeleton's names says."""
    known = set(names)
    return [_word(name, known) for name in names]


def _word(name: str, known: set[str]) -> Word:
    plain = re.split("[:|]", name)[-1]
    words = [one.lower() for one in _WORDS.findall(plain)]
    side = _side(name, words, known)
    if side is not None and not set(words) & (_LEFT | _RIGHT) and words:
        words[0] = words[0][1:]  # glued: lfemur
    said = [one for one in words if not (one in _LEFT | _RIGHT or one.isdigit())]
    said = [one for one in said if not _EMPTY.fullmatch(one)] or said
    told = "".join(said)
    odd = plain.startswith("__") or bool(_ODD.intersection(said) or _HELPER.search(told))
    weights = {} if odd else _weights(told, _MIDDLE if side is None else _LIMBS)
    front = side is not None and not odd and bool(_FORE.match(told))
    if front:
        weights = {_FRONT.get(part, part): weight for part, weight in weights.items()}
    return Word(side, weights, odd, front, told)


def _side(name: str, words: Sequence[str], known: set[str]) -> Side | None:
    other = other_side(name, known)
    if other is not None and other in known:
        return "left" if is_left(name, other) else "right"
    if _LEFT.intersection(words):
        return "left"
    return "right" if _RIGHT.intersection(words) else None


def _weights(told: str, patterns: Sequence[tuple[str, dict[str, float]]]) -> dict[str, float]:
    return next((dict(found) for pattern, found in patterns if re.search(pattern, told)), {})
