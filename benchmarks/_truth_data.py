"""The captures with truth, takes joined from cuts of them, and random motion without any period."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from roundelay.geometry import rotations as rot

Array = NDArray[np.float64]

# Repetitions in a cut of a class: four steps of a jog are two strides.
COUNTED = {
    "squat1Reps": 1,
    "elbowToKnee1RepsLelbowStart": 1,
    "rotateArmsBothBackward1Reps": 1,
    "hopBothLegs1hops": 1,
    "kickLFront1Reps": 1,
    "sneak2StepsLStart": 1,
    "jogLeftCircle4StepsRstart": 2,
    "depositFloorR": 1,
    "grabHighR": 1,
}
# Actions that a person does unlike every time.
UNLIKE = ("depositFloorR", "grabHighR")
# Seconds over which the step at a join fades.
BLEND = 0.25


@dataclass(frozen=True)
class Stretch:
    """Frames in which the feet or the hands repeat, with their period in seconds."""

    start: int
    stop: int
    period: float
    limbs: str
    correlation: float


@dataclass(frozen=True)
class Capture:
    """A file, what it shows, and what is known of it."""

    file: str
    source: str
    label: str
    kind: str
    frames: int
    fps: float
    # Seconds, of one gait from end to end.
    period: float | None
    stretches: tuple[Stretch, ...]
    negatives: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Joined:
    """Cuts of one class and actor, in two orders, and how many repetitions they hold."""

    label: str
    files: tuple[str, ...]
    again: tuple[str, ...]
    count: int


@dataclass(frozen=True)
class Random:
    """Smooth random motion: how many signals drive how many joints, for how many seconds."""

    synergies: int
    joints: int
    seconds: int
    seed: int


def captures(folder: Path) -> list[Capture]:
    """Read the tables of captures, stretches and negatives."""
    stretches: dict[str, list[Stretch]] = {}
    for row in _rows(folder / "stretches.csv"):
        stretches.setdefault(row["file"], []).append(
            Stretch(
                int(row["start_frame"]),
                int(row["stop_frame"]),
                float(row["period_seconds"]),
                row["limbs"],
                float(row["correlation"]),
            )
        )
    negatives: dict[str, list[tuple[int, int]]] = {}
    for row in _rows(folder / "negatives.csv"):
        frames = int(row["start_frame"]), int(row["stop_frame"])
        negatives.setdefault(row["file"], []).append(frames)
    return [
        Capture(
            row["file"],
            row["source"].replace("bandai1", "bandai").replace("bandai2", "bandai"),
            row["class"],
            row["kind"],
            int(row["frames"]),
            float(row["fps"]),
            float(row["period_throughout"]) if row["throughout"] == "1" else None,
            tuple(stretches.get(row["file"], ())),
            tuple(negatives.get(row["file"], ())),
        )
        for row in _rows(folder / "captures.csv")
    ]


def _rows(path: Path) -> Iterator[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as lines:
        yield from csv.DictReader(lines)


def joins(table: Sequence[Capture], count: int) -> list[Joined]:
    """Draw takes of 3 to 5 cuts each, the classes in turn and of one actor each."""
    rng = np.random.default_rng(20261127)
    pools: dict[str, dict[str, list[str]]] = {}
    for capture in table:
        if capture.label in COUNTED:
            actor = Path(capture.file).name.split("_")[1]
            pools.setdefault(capture.label, {}).setdefault(actor, []).append(capture.file)
    drawn: list[Joined] = []
    for number in range(count):
        label = list(COUNTED)[number % len(COUNTED)]
        enough = [files for files in pools[label].values() if len(files) >= 3]
        for _ in range(20):  # another one, while there are
            one = _draw(label, enough[rng.integers(len(enough))], rng)
            if one.files not in [each.files for each in drawn]:
                break
        drawn.append(one)
    return drawn


def _draw(label: str, files: list[str], rng: np.random.Generator) -> Joined:
    most = min(5, len(files))
    cuts = [files[i] for i in rng.permutation(len(files))[: rng.integers(3, most + 1)]]
    again = _another_order(cuts, rng)
    return Joined(label, tuple(cuts), tuple(again), COUNTED[label] * len(cuts))


def _another_order(cuts: list[str], rng: np.random.Generator) -> list[str]:
    while True:
        again = [cuts[i] for i in rng.permutation(len(cuts))]
        if again != cuts:
            return again


def joined(motions: Sequence[rl.Motion], blend: float = BLEND) -> rl.Motion:
    """Join motions, each begun where the one before ends and in its heading.

    No frame is left out: the step of the pose at a join is taken back within `blend` seconds.
    """
    taken = [motions[0]]
    for motion in motions[1:]:
        taken.append(_continued(taken[-1], motion, blend))
    return rl.concatenate(taken)


def _continued(before: rl.Motion, motion: rl.Motion, blend: float) -> rl.Motion:
    up = motion.up_vector
    step = rot.multiply(before.rotations[-1, 0], rot.conjugate(motion.rotations[0, 0]))
    turn = rot.twist(step, up)
    path = rot.rotate(turn, motion.root_path - motion.root_path[0])
    # Where the hips stand on the floor is no matter; how high they are is.
    path += before.root_path[-1] * (1.0 - up) + motion.root_path[0] * up
    turned = motion.rotations.copy()
    turned[:, 0] = rot.multiply(turn, turned[:, 0])
    fade = _fade(len(motion), blend * motion.fps)
    left = rot.to_rotation_vector(rot.multiply(before.rotations[-1], rot.conjugate(turned[0])))
    turned = rot.multiply(rot.from_rotation_vector(fade[:, None, None] * left), turned)
    path = path + fade[:, None] * (before.root_path[-1] - path[0])
    return replace(motion, rotations=turned, root_path=path)


def _fade(frames: int, blend: float) -> Array:
    """Fall smoothly from 1 to 0 over so many frames."""
    part = np.clip(np.arange(frames) / blend, 0.0, 1.0)
    return 0.5 + 0.5 * np.cos(np.pi * part)


def random_takes(seeds: int) -> list[Random]:
    """List takes of 3, 5, 8 signals, and those of two signals or one joint, apart."""
    kinds = [(k, joints) for k in (3, 5, 8) for joints in (4, 20)]
    kinds += [(2, 4), (2, 20), (3, 1)]
    return [
        Random(synergies, joints, seconds, seed)
        for seed in range(seeds)
        for seconds in (10, 30, 300)
        for synergies, joints in kinds
    ]


def random_motion(take: Random, fps: float = 30.0) -> rl.Motion:
    """Turn all joints by fixed mixtures of a few signals that never return but by chance."""
    rng = np.random.default_rng([take.seed, take.synergies, take.joints, take.seconds])
    frames, skeleton = round(take.seconds * fps), _limbs_of_four(take.joints)
    # Every second seed three times as slow.
    drive = _band_limited(rng, frames, take.synergies, fps, (0.33, 1.0)[take.seed % 2])
    angles = (drive @ rng.normal(size=(take.synergies, 3 * take.joints))).reshape(frames, -1, 3)
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (frames, skeleton.n_joints, 1))
    rotations[:, 1 : take.joints + 1] = rot.from_rotation_vector(0.4 * angles / angles.std())
    path = np.tile([0.0, 0.9, 0.0], (frames, 1))
    return rl.Motion(skeleton, rotations, path, 1.0 / fps, name="random")


def _band_limited(
    rng: np.random.Generator, frames: int, count: int, fps: float, seconds: float
) -> Array:
    """Draw Gaussian signals with a Gaussian spectrum: correlation exp(-t^2 / 4 seconds^2)."""
    # A tail is cut off, lest the end meet the beginning.
    whole = frames + int(10 * seconds * fps)
    frequency = np.fft.rfftfreq(whole, 1.0 / fps)
    spectrum = np.fft.rfft(rng.normal(size=(whole, count)), axis=0)
    spectrum *= np.exp(-2.0 * (np.pi * frequency * seconds) ** 2)[:, None]
    signals = np.fft.irfft(spectrum, whole, axis=0)[:frames]
    return signals / signals.std(axis=0)


def _limbs_of_four(joints: int) -> rl.Skeleton:
    """Hang chains of up to four joints on a root, each with an end."""
    # What a single joint turns is seen at another that hangs on it.
    count = max(joints, 2)
    parents = (-1, *(0 if i % 4 == 0 else i for i in range(count)))
    aim = 2 * np.pi * (np.arange(count) // 4) / -(-count // 4)
    bones = 0.25 * np.column_stack((np.cos(aim), np.sin(aim), 0 * aim))
    last = [i for i in range(1, count + 1) if i % 4 == 0 or i == count]
    names = ("root", *(f"joint{i}" for i in range(1, count + 1)))
    ends = tuple((i, bones[i - 1]) for i in last)
    return rl.Skeleton(names, parents, np.vstack((np.zeros(3), bones)), ends)
