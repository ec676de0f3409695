# SPDX-License-Identifier: GPL-3.0-or-later
"""Play an armature frame by frame: where its bones are, and what its properties are then."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from .compat import Armature
from .keyed import Property, Samples

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Played:
    """What was seen.

    Attributes
    ----------
    matrices : (F, k, 4, 4) ndarray
        Of some bones, in the armature.
    places : (F, 4, 4) ndarray
        The armature's own matrix.
    samples : dict
        Of some properties, values (F, n).
    """

    matrices: Array = field(repr=False)
    places: Array = field(repr=False)
    samples: Samples = field(repr=False)


def play(
    armature: Armature,
    scene: bpy.types.Scene,
    frames: Sequence[float],
    bones: Sequence[str],
    properties: Iterable[Property] = (),
) -> Generator[float, None, Played]:
    """Set every frame, yielding the fraction done; the scene's own frame is set again after."""
    pose, current = armature.pose.bones, scene.frame_current
    where = [pose.find(name) for name in bones]
    taken = list(properties)
    samples: dict[Property, list[Array]] = {one: [] for one in taken}
    matrices, places = np.empty((len(frames), len(bones), 4, 4)), np.empty((len(frames), 4, 4))
    buffer = np.empty(16 * len(pose), np.float32)
    try:
        for row, frame in enumerate(frames):
            scene.frame_set(int(frame // 1), subframe=float(frame % 1))
            pose.foreach_get("matrix", buffer)
            matrices[row] = buffer.reshape(-1, 4, 4)[where].transpose(0, 2, 1)
            places[row] = armature.matrix_basis
            for one in taken:
                samples[one].append(one.now())
            yield row / len(frames)
    finally:
        scene.frame_set(current)
    found = {one: np.array(each) for one, each in samples.items()}
    return Played(matrices, places, found)
