"""What the search takes for periodic in noise, and what it finds in noisy closed curves.

Usage: python -m benchmarks.significance [--runs 200] [--frames 300] [--quick] [--json] [--keep]

Every case is searched as a user's would be, by `roundelay.find_periodic` with its defaults, and
counts as found if it is not refused; "sure" are those with a confidence of .9 or more.

Nothing repeats but by chance in clouds of independent points, random walks and Ornstein-Uhlenbeck
processes (10 dimensions, 30 frames a second), nor in random smooth motions of a body, whose joints
all follow 2, 3, 5 or 8 independent signals (60 frames a second, a third of a second of memory).
A closed curve of size 1 is run through four times, with noise of a given size in all directions;
its period counts as right within 5 %.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._harness import Target, parser, report
from roundelay import synth
from roundelay.geometry import rotations as rot

Points = NDArray[np.float64]
DIMENSIONS = 10
TURNS = 4
NOISES = (0.1, 0.2, 0.3, 0.5)
SYNERGIES = (2, 3, 5, 8)
SURE = 0.9
TARGETS = (
    Target("noise.found_percent", "<=", 5, "percent of the clouds of noise taken for periodic"),
    Target("smooth.found_percent", "<=", 5, "percent of random smooth motions taken for periodic"),
    Target("curves.cases.noise 30 %.right_percent", ">=", 95, "closed curves found, period right"),
)


@dataclass(frozen=True)
class Cloud:
    """What `roundelay.find_periodic` asks of a take: here ten points that move on a line each."""

    values: Points
    names: tuple[str, ...] = tuple(f"point {number}" for number in range(DIMENSIONS))
    groups: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    missing: None = None
    fps: float = 30.0
    size: float = 1.0


Take = rl.Motion | Cloud
Draw = Callable[[np.random.Generator, int], Take]


def cloud(points: Points) -> Cloud:
    return Cloud(points[:, :, None])


def independent(rng: np.random.Generator, frames: int) -> Take:
    return cloud(rng.normal(size=(frames, DIMENSIONS)))


def random_walk(rng: np.random.Generator, frames: int) -> Take:
    return cloud(np.cumsum(rng.normal(size=(frames, DIMENSIONS)), axis=0))


def ornstein_uhlenbeck(rng: np.random.Generator, frames: int) -> Take:
    """A process that forgets itself in a tenth of the recording."""
    keep = np.exp(-10 / frames)
    steps = np.sqrt(1 - keep**2) * rng.normal(size=(frames, DIMENSIONS))
    steps[0] = rng.normal(size=DIMENSIONS)
    for t in range(1, frames):
        steps[t] += keep * steps[t - 1]
    return cloud(steps)


def smooth_motion(synergies: int, fps: float = 60.0) -> Draw:
    """A body whose joints follow a few signals without period, twice as many frames as asked."""

    def draw(rng: np.random.Generator, frames: int) -> Take:
        skeleton, count, spread = synth.humanoid(), 2 * frames, fps / 3
        window = np.exp(-0.5 * (np.arange(-3 * spread, 3 * spread + 1) / spread) ** 2)
        noise = rng.normal(size=(synergies, count + len(window) - 1))
        signals = np.array([np.convolve(one, window, "valid") for one in noise])
        turns = np.tensordot(signals, rng.normal(size=(synergies, skeleton.n_joints, 3)), (0, 0))
        rotations = rot.from_rotation_vector(turns * (0.4 / turns.std()))
        return rl.Motion(skeleton, rotations, np.zeros((count, 3)), 1.0 / fps)

    return draw


def closed_curve(noise: float) -> Draw:
    """Four turns of a random closed curve of size 1, with noise of that size in all directions."""

    def draw(rng: np.random.Generator, frames: int) -> Take:
        angle = 2 * np.pi * np.linspace(0, TURNS, frames)[:, None] * np.arange(1, 4)
        waves = np.concatenate((np.cos(angle), np.sin(angle)), axis=1) / [1, 2, 3, 1, 2, 3]
        frame = np.linalg.qr(rng.normal(size=(DIMENSIONS, 6)))[0]
        spread = noise / np.sqrt(DIMENSIONS) * rng.normal(size=(frames, DIMENSIONS))
        return cloud(waves @ frame.T + spread)

    return draw


def cases() -> Iterator[tuple[str, str, Draw]]:
    yield "noise", "independent", independent
    yield "noise", "walk", random_walk
    yield "noise", "ornstein_uhlenbeck", ornstein_uhlenbeck
    for count in SYNERGIES:
        yield "smooth", f"{count} signals", smooth_motion(count)
    for noise in NOISES:
        yield "curves", f"noise {round(100 * noise)} %", closed_curve(noise)


def verdict(take: Take, frames: int) -> tuple[bool, bool, bool]:
    """Whether something periodic is found, whether surely, whether with the curve's period."""
    try:
        found = rl.find_periodic(take)[0]
    except (rl.NoPeriod, rl.TooShort):
        return False, False, False
    period = (frames - 1) / TURNS
    return True, (found.confidence or 0.0) >= SURE, abs(found.period / period - 1.0) <= 0.05


def measure(runs: int, frames: int) -> list[dict[str, Any]]:
    rows = []
    for group, name, draw in cases():
        seen = [verdict(draw(np.random.default_rng(k), frames), frames) for k in range(runs)]
        found, sure, right = np.sum(seen, axis=0).tolist()
        row = {"group": group, "case": name, "runs": runs, "found": found, "sure": sure}
        rows.append(row | ({"right": right} if group == "curves" else {}))
    return rows


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Percent by group, and of each case by itself."""
    result: dict[str, Any] = {}
    for group in dict.fromkeys(row["group"] for row in rows):
        chosen = [row for row in rows if row["group"] == group]
        cases = {row["case"]: _percent([row]) for row in chosen}
        result[group] = {**_percent(chosen), "cases": cases}
    return result


def _percent(rows: list[dict[str, Any]]) -> dict[str, Any]:
    runs = sum(row["runs"] for row in rows)
    shares = {
        f"{key}_percent": round(100 * sum(row[key] for row in rows) / runs, 2)
        for key in ("found", "sure", "right")
        if key in rows[0]
    }
    return {"runs": runs, **shares}


def main() -> None:
    options = parser(__doc__, data=None)
    options.add_argument("--runs", type=int, default=200)
    options.add_argument("--frames", type=int, default=300)
    options.add_argument("--quick", action="store_true", help="20 runs")
    arguments = options.parse_args()
    rows = measure(20 if arguments.quick else arguments.runs, arguments.frames)
    table = (
        f"{row['group']:8} {row['case']:20} of {row['runs']} found {row['found']:4} "
        f"sure {row['sure']:4} right {row.get('right', '-'):>4}"
        for row in rows
    )
    report("significance", {"summary": summary(rows)}, TARGETS, arguments, table=table)


if __name__ == "__main__":
    main()
