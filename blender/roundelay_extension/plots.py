# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots of a capture's poses and its loop on their principal axes, as SVG."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from roundelay import Cycle, Motion
from roundelay.motion.features import point_cloud
from roundelay.motion.poses import principal_components

_SIZE, _MARGIN = 600, 30
# What the name of an action may hold and that of a file may not, on Windows: "Armature|walk".
_FORBIDDEN = re.compile(r'[\x00-\x1f"*/:<>?\\|]')


def folder_of(settings: Any) -> str:
    """Return the folder asked for.

    Raises
    ------
    ValueError
        If it is beside a file that was never saved.
    """
    folder: str = settings.plot_folder
    if folder.startswith("//") and not bpy.data.filepath:
        raise ValueError("the file is not saved, so that // is nowhere: save it or choose a folder")
    return bpy.path.abspath(folder)


def write(motion: Motion, cycle: Cycle, loop: Motion, folder: str, name: str) -> Path:
    """Write one plot, grey the frames the loop was made from and red the loop."""
    runs = cycle.evidence.runs if cycle.evidence else ((0, len(motion)),)
    source = point_cloud(motion.with_root_motion())
    clouds = [*(source[start:stop] for start, stop in runs), point_cloud(loop)]
    plane = principal_components(np.concatenate(clouds), 2)
    plane = np.pad(plane, ((0, 0), (0, 2 - plane.shape[1])))
    low, span = plane.min(axis=0), max(float(np.ptp(plane, axis=0).max()), 1e-9)
    placed = _MARGIN + (plane - low) / span * (_SIZE - 2 * _MARGIN)
    pieces = np.split(placed, np.cumsum([len(cloud) for cloud in clouds])[:-1])
    lines = [_line(piece, "#888", 1) for piece in pieces[:-1]] + [_line(pieces[-1], "#c22", 3)]
    path = Path(folder) / f"{_FORBIDDEN.sub('_', name)}.svg"
    path.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_SIZE}" height="{_SIZE}">'
        f'<rect width="100%" height="100%" fill="white"/>{"".join(lines)}</svg>\n',
        encoding="utf-8",
    )
    return path


def _line(points: NDArray[np.float64], colour: str, width: int) -> str:
    listed = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{listed}" fill="none" stroke="{colour}" stroke-width="{width}"/>'
