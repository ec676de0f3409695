"""Takes joined from what people named as one behaviour each, in which behaviours come back."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._truth_data import COUNTED, joined
from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.segmentation import Truth

Array = NDArray[np.float64]

# Seconds over which one behaviour goes over into the next.
BLEND = 0.4
# Seconds of a part of a clip of one behaviour.
PART = 8.0
# Behaviours a take, and different ones among them.
PARTS, KINDS = 9, 5


@dataclass(frozen=True)
class Take:
    """A joined take: where it was joined, and what it is joined from."""

    source: str
    motion: rl.Motion
    truth: Truth


@dataclass(frozen=True)
class Part:
    """Frames of one behaviour, by the name that people gave it."""

    label: str
    motion: rl.Motion


def take_of(source: str, parts: Sequence[Part], drift: float = 0.0, seed: int = 0) -> Take:
    """Join parts; what is cut there may drift in posture by so many radians."""
    first = parts[0].motion
    motions = [
        replace(
            part.motion, skeleton=first.skeleton, frame_time=first.frame_time, translations=None
        )
        for part in parts
    ]
    motion = joined(motions, BLEND)
    if drift:
        motion = drifting(motion, drift, seed)
    bounds = np.cumsum([0, *(len(each) for each in motions)])
    segments = tuple(
        (int(start), int(stop), part.label)
        for start, stop, part in zip(bounds[:-1], bounds[1:], parts, strict=True)
    )
    blend = round(BLEND * motion.fps)
    windows = tuple((int(cut), int(cut) + blend) for cut in bounds[1:-1])
    return Take(source, motion, Truth(segments, windows, motion.frame_time))


def drifting(motion: rl.Motion, deviation: float, seed: int, memory: float = 4.0) -> rl.Motion:
    """Let the posture of all joints but the root wander slowly, as a person's does."""
    rng = np.random.default_rng(seed)
    count = len(motion) + round(12 * memory * motion.fps)
    frequency = np.fft.rfftfreq(count, motion.frame_time)
    # A noise that was filtered twice by a decay of `memory` seconds.
    gain = 1.0 / (1.0 + (2.0 * np.pi * frequency * memory) ** 2)
    noise = np.fft.rfft(rng.normal(size=(count, motion.skeleton.n_joints, 3)), axis=0)
    wander = np.fft.irfft(noise * gain[:, None, None], count, axis=0)
    wander = deviation * (wander / wander.std(axis=0))[-len(motion) :]
    wander[:, 0] = 0.0
    turned = rot.multiply(motion.rotations, rot.from_rotation_vector(wander))
    return replace(motion, rotations=turned)


def _order(labels: Sequence[str], rng: np.random.Generator, parts: int = PARTS) -> list[str]:
    """Draw behaviours of which most come back, none beside itself."""
    chosen = [labels[i] for i in rng.permutation(len(labels))[:KINDS]]
    order = list(chosen)
    while len(order) < parts:
        more = [each for each in chosen if each != order[-1]]
        order.append(more[rng.integers(len(more))])
    return order


def _drawn(
    source: str, pools: dict[str, list[rl.Motion]], rng: np.random.Generator, drift: float
) -> Take:
    """Join one take; a behaviour comes back as another part of its own, while there are."""
    left = {
        label: [parts[i] for i in rng.permutation(len(parts))] for label, parts in pools.items()
    }
    parts = []
    for label in _order(list(pools), rng):
        again = left[label].pop(0)
        left[label].append(again)
        parts.append(Part(label, again))
    return take_of(source, parts, drift, int(rng.integers(1 << 30)))


def single_behaviours(folder: Path) -> dict[str, rl.Motion]:
    """Read the clips that people cut out as one behaviour, by name."""
    files = sorted((folder / "single_behaviour").glob("*.bvh"))
    return {path.stem: _read(path) for path in files}


def _read(path: Path, skeleton: Path | None = None) -> rl.Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return rl.read(path) if skeleton is None else rl.read(path, skeleton=skeleton)


def clip_joins(folder: Path, count: int, drift: float = 0.0, seed: int = 1) -> list[Take]:
    """Join parts of the clips of one behaviour: posture, place and course really differ."""
    pools: dict[str, list[rl.Motion]] = {}
    for name, motion in single_behaviours(folder).items():
        # One person's walks are one behaviour, whatever take each was cut from.
        _, person, behaviour, _ = name.split("_")
        pools.setdefault(f"{behaviour} of {person}", []).extend(_in_parts(motion, PART))
    pools = {label: parts for label, parts in pools.items() if len(parts) >= 2}
    rng = np.random.default_rng(seed)
    return [_drawn("clips", pools, rng, drift) for _ in range(count)]


def _in_parts(motion: rl.Motion, seconds: float) -> list[rl.Motion]:
    frames = round(seconds * motion.fps)
    return [motion[a : a + frames] for a in range(0, len(motion) - frames + 1, frames)]


def hdm_joins(folder: Path, count: int, drift: float = 0.0, seed: int = 2) -> list[Take]:
    """Join behaviours of an actor, each of three cuts of one class."""
    rng = np.random.default_rng(seed)
    pools = {actor: _hdm_pools(folder, actor) for actor in ("bd", "mm")}
    takes = []
    for number in range(count):
        pool = pools[("bd", "mm")[number % 2]]
        behaviours = {label: _threes(files, rng) for label, files in pool.items()}
        takes.append(_drawn("hdm05", behaviours, rng, drift))
    return takes


def _hdm_pools(folder: Path, actor: str) -> dict[str, list[rl.Motion]]:
    skeleton = folder / "hdm05" / f"HDM_{actor}.asf"
    classes = (*COUNTED, "throwBasketball")
    found = {name: sorted((folder / "hdm05").glob(f"HDM_{actor}_{name}_*.amc")) for name in classes}
    return {
        name: [_read(path, skeleton) for path in paths] for name, paths in found.items() if paths
    }


def _threes(cuts: Sequence[rl.Motion], rng: np.random.Generator) -> list[rl.Motion]:
    """Join three cuts at a time, all of them once; fewer where there are no more."""
    drawn = [cuts[i] for i in rng.permutation(len(cuts))]
    whole = max(1, len(drawn) // 3)
    return [joined(drawn[k::whole][:3]) for k in range(whole)]


def bandai_joins(folder: Path, count: int, drift: float = 0.0, seed: int = 3) -> list[Take]:
    """Join clips; a behaviour is what is done and in which style."""
    rng = np.random.default_rng(seed)
    pools = (_bandai_pools(folder / "bandai1"), _bandai_pools(folder / "bandai2"))
    return [_drawn("bandai", pools[number % 2], rng, drift) for number in range(count)]


def _bandai_pools(folder: Path, least: float = 2.0) -> dict[str, list[rl.Motion]]:
    """Halves of long clips are parts that come back."""
    pools: dict[str, list[rl.Motion]] = {}
    for path in sorted(folder.glob("*.bvh")):
        motion = _read(path)
        halves = 2 if motion.duration >= 2 * least + 1 else 1
        parts = _in_parts(motion, motion.duration / halves - motion.frame_time)
        if motion.duration >= least:
            pools.setdefault(path.stem.split("_", 1)[1].rsplit("_", 1)[0], []).extend(parts)
    return pools


def short_joins(folder: Path, seconds: float, count: int, seed: int = 4) -> list[Take]:
    """Join behaviours of a second or two, of Bandai-Namco and HDM05 in turn."""
    rng = np.random.default_rng([seed, round(10 * seconds)])
    bandai = [_bandai_pools(folder / name) for name in ("bandai1", "bandai2")]
    hdm = [_hdm_pools(folder, actor) for actor in ("bd", "mm")]
    pools = [_middles(pool, seconds) for pool in (*bandai, *hdm)]
    return [_drawn("short", pools[number % len(pools)], rng, 0.0) for number in range(count)]


def _middles(pools: dict[str, list[rl.Motion]], seconds: float) -> dict[str, list[rl.Motion]]:
    """Cut the middle out of each part that is long enough."""
    cut: dict[str, list[rl.Motion]] = {}
    for label, motions in pools.items():
        for motion in motions:
            frames = round(seconds * motion.fps)
            start = (len(motion) - frames) // 2
            if start >= 0:
                cut.setdefault(label, []).append(motion[start : start + frames])
    return cut


def drifting_walks(deviations: Sequence[float], seeds: int) -> Iterator[rl.Motion]:
    """Make walks of a minute whose posture wanders."""
    walk = synth.gait("walk", repetitions=60 / 1.1, period=1.1, fps=60.0, seed=1).motion
    for deviation in deviations:
        for seed in range(seeds):
            yield drifting(walk, deviation, seed)


def drifting_joins(deviation: float, count: int, seconds: float = 9.0, seed: int = 5) -> list[Take]:
    """Join made gaits of one person whose posture wanders."""
    rng = np.random.default_rng(seed)
    periods = {"walk": 1.1, "run": 0.75, "jacks": 1.2, "punch": 0.9}
    pools = {
        kind: [
            synth.gait(kind, repetitions=seconds / period, period=period, fps=60.0, seed=1).motion
        ]
        for kind, period in periods.items()
    }
    return [_drawn("made", pools, rng, deviation) for _ in range(count)]


def long_take(folder: Path, minutes: float) -> rl.Motion:
    """Join the takes of a folder over and over, and cut them to length."""
    motions = [_read(path) for path in sorted(folder.glob("*.bvh"))]
    motions = [replace(one, skeleton=motions[0].skeleton, translations=None) for one in motions]
    frames, whole = round(minutes * 60.0 * motions[0].fps), []
    while sum(map(len, whole)) < frames:
        whole.append(motions[len(whole) % len(motions)])
    return joined(whole, BLEND)[:frames]
