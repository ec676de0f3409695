"""Landmarks of people: which bone a marker or keypoint is on, by its name.

Names are those of the known sets, of the ISB's and CAST protocols (Leardini et al. 2007), of Davis'
protocol and of what laboratories write in French. Case, blanks, dots, dashes and a subject's prefix
do not count; the side is a letter or word in front or behind.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from roundelay.motion.point_sets import known_set, plain_name

__all__ = ["KEYPOINT_SETS", "Landmark", "computed", "landmarks_of"]

KEYPOINT_SETS = ("OpenPose BODY_25", "MediaPipe 33", "COCO")
"""Known sets whose points are joint centres, not markers on the skin."""


@dataclass(frozen=True)
class Landmark:
    """Name a place of the body.

    Attributes
    ----------
    side : {"Left", "Right", ""}
    name : str
        Such as "asis" or "knee lateral".
    bone : str
        The joint whose bone it is on, as in "LeftUpLeg".
    """

    side: str
    name: str
    bone: str


# Landmark, the bone that carries it (* for the side), and how it is called.
_MARKERS = """
asis: Hips: asi asis ias eias eas
psis: Hips: psi psis ips eips eps
sacrum: Hips: sacr sacrum vsacral vsac sacral
crest: Hips: crete crest iliaccrest
trochanter: *UpLeg: gt ftc troc trochanter greatertrochanter hip
thigh: *UpLeg: thi thigh bar1 wand1 tht thf
knee lateral: *UpLeg: kne knee knee1 fle kneelat kneelateral cl lfc lk
knee medial: *UpLeg: knm kneemed kneemedial fme knein kneein cm mfc mk
fibula: *Leg: fax fibula knee2 hf headfibula
tuberosity: *Leg: ttc tta tibialtuberosity
shank: *Leg: tib shank sha bar2 wand2
ankle lateral: *Leg: ank ankle mall fal anklelat anklelateral ml la malleolus
ankle medial: *Leg: anm anklemed anklemedial tam ankin anklein mm ma
heel: *Foot: hee heel cal calca fcc calcaneus
toe: *Foot: toe met hal hallux mt2
toe medial: *Foot: fm1 mt1 footmed footmedial
toe lateral: *Foot: fm5 mt5 footlat footlateral
c7: Spine: c7 cv7
back: Spine: t8 t10 t12 tv8 tv10
jugular: Spine: clav ij snj
xiphoid: Spine: strn px sxs xiph ster sternum
scapula: *Shoulder: bak scap scapula offset off ang angulus aa
acromion: *Shoulder: sho shoulder should saj acr acromion ac cla
upper arm: *Arm: upa upperarm uhe biceps hum arm
humeral head: *Arm: headhum
elbow lateral: *Arm: elb elbow hle epilat elbowlat elbowlateral lateralepicondyle
elbow medial: *Arm: elm hme epimed elbowmed elbowmedial medialepicondyle
ulna: *ForeArm: ulna olecrane
forearm: *ForeArm: frm fra forearm
wrist radial: *ForeArm: wra wri wrist wristrad rsp radialstyloid
wrist ulnar: *ForeArm: wrb wristuln wristulna usp ulnarstyloid
hand: *Hand: fin hand hm2 mc2 d2m1 main
hand ulnar: *Hand: hm5 mc5 d5m1
head: Head: fhd bhd hdf hdb tet head fronthead rearhead topofhead tophead forehead teteh
temple: Head: templel ear
"""
_KEYPOINTS = """
hips: Hips: midhip
hip: *UpLeg: hip
knee: *Leg: knee
ankle: *Foot: ankle
heel: *Foot: heel
toe: *Foot: bigtoe footindex
toe lateral: *Foot: smalltoe
neck: Spine: neck
shoulder: *Arm: shoulder
elbow: *ForeArm: elbow
wrist: *Hand: wrist
hand: *Hand: index
hand ulnar: *Hand: pinky
thumb: *Hand: thumb
nose: Head: nose
ear: Head: ear
eye: Head: eye eyeinner eyeouter
mouth: Head: mouth
"""
# What Plug-in Gait computes and writes beside markers: axes of segments and centres of mass.
_COMPUTED = re.compile(
    r"(ped|hed|trx|pel)[oalp]|[lr](cl|hu|ra|hn|fe|ti|fo|to)[oalp]|centreofmass(floor)?"
    r"|[lr].*(angles?|force|moment|power|grf|score|nm|gamage|hipcenter)v?"
)
_SIDES = {"left": "Left", "right": "Right", "l": "Left", "r": "Right"}


def _table(text: str) -> dict[str, tuple[str, str]]:
    """Return landmark and bone by how it is called."""
    found = {}
    for line in text.split("\n"):
        if line:
            name, bone, words = (part.strip() for part in line.split(":"))
            found.update(dict.fromkeys(words.split(), (name, bone)))
    return found


_TABLES = {True: _table(_KEYPOINTS), False: _table(_MARKERS)}


def computed(name: str) -> bool:
    """Tell whether a point is one that Plug-in Gait computes, no marker."""
    return _COMPUTED.fullmatch(plain_name(name)) is not None


def landmarks_of(names: Sequence[str]) -> list[Landmark | None]:
    """Return the landmark of each point by its name; None for those without one."""
    one = known_set(names)
    table = _TABLES[one is not None and one.name in KEYPOINT_SETS]
    return [_landmark(plain_name(name), table) for name in names]


def _landmark(plain: str, table: dict[str, tuple[str, str]]) -> Landmark | None:
    for word, side in _SIDES.items():
        for rest, there in (
            (plain.removeprefix(word), plain.startswith(word)),
            (plain.removesuffix(word), plain.endswith(word)),
            # As in "mouth_left" and "left_eye_inner" the side may stand in the middle.
        ):
            if there and rest in table:
                name, bone = table[rest]
                return Landmark(side, name, bone.replace("*", side))
    if plain in table and "*" not in table[plain][1]:
        name, bone = table[plain]
        return Landmark("", name, bone)
    return None
