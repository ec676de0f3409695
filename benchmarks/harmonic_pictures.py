"""Pictures of the rows where [C] fails, before and after.

python -m benchmarks.harmonic_pictures --data FOLDER --out FOLDER
"""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import roundelay
from benchmarks.harmonic import captures, load
from benchmarks.raunio_tables import PUBLISHED, SCALE
from roundelay.reproduction import raunio
from roundelay.reproduction.configuration import euler_angles

# Rows where [C] fails: an error above .8 or one period.
FAILED = ("02_01", "07_09", "16_08", "16_55", "16_57", "35_19", "35_26")

# Whose methods some functions run, which no user's path does.
LABELLED = {"pictures": "[C] M1"}


def pictures(data: Path, folder: Path) -> None:
    """Draw the rows where [C] fails: joint angles on principal axes, and the fastest over time."""
    folder.mkdir(parents=True, exist_ok=True)
    figure = Figure(figsize=(12, 3 * len(FAILED)), layout="constrained")
    axes = figure.subplots(len(FAILED), 3)
    for row, (trial, (plane, before, after)) in enumerate(zip(FAILED, axes, strict=True)):
        published = next(row for row in PUBLISHED if row.trial == trial)
        motion = load(captures(data)[trial], None)
        angles = euler_angles(motion, motion.rotations).reshape(len(motion), -1)
        loops = {}
        with contextlib.suppress(roundelay.RoundelayError):
            loops["M1, faithful"] = raunio.with_primes(
                angles, raunio.PaperOptions(scale=SCALE[published.kind])
            ).sample()
        with contextlib.suppress(roundelay.RoundelayError):
            loop = roundelay.find_cycles(motion)[0].sample(in_place=True)
            own = euler_angles(motion, loop.rotations).reshape(len(loop), -1)
            loops["default"] = own - 2 * np.pi * np.round(
                (own.mean(axis=0) - angles.mean(axis=0)) / (2 * np.pi)
            )
        middle = angles.mean(axis=0)
        principal = np.linalg.svd(angles[:, 3:] - middle[3:], full_matrices=False)[2][:2]
        spread = np.ptp(angles[:, 3:], axis=0)
        channel = 3 + int(np.argmax(np.where(spread < 2.5, spread, 0.0)))
        plane.plot(*((angles[:, 3:] - middle[3:]) @ principal.T).T, color="0.75")
        plane.set_title(f"{trial}: published {published.template[0]:.2f} rad")
        for axis, (name, color) in zip(
            (before, after), (("M1, faithful", "C3"), ("default", "C0")), strict=True
        ):
            axis.set_title(name if name in loops else f"{name}: none found")
            axis.plot(angles[:, channel], color="0.75")
            if name in loops:
                closed = np.concatenate([loops[name], loops[name][:1]])
                plane.plot(*((closed[:, 3:] - middle[3:]) @ principal.T).T, color=color)
                shift = raunio.template_error(angles[:, 3:], loops[name][:, 3:])[1]
                there = (np.arange(len(angles)) + shift) % len(loops[name])
                axis.plot(loops[name][there, channel], color=color)
    figure.savefig(folder / "harmonic_failed_rows.png", dpi=70)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    pictures(arguments.data, arguments.out)
