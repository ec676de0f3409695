"""The process that reads an HDF5 file by `movement` and leaves an NPZ; see `formats.animals`.

Usage: python -m roundelay.formats.animals_child FILE NPZ
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from roundelay.formats.apart import answer

__all__ = ["main"]


def main() -> None:
    """Read the file and write what it holds; see `roundelay.formats.apart.answer`."""
    answer(_read)


def _read(path: Path) -> dict[str, Any]:
    """Return the arrays of an NPZ."""
    import h5py
    from movement.io import load_dataset

    software = "SLEAP"
    if path.suffix == ".h5":
        with h5py.File(path) as file:
            software = "SLEAP" if "tracks" in file else "DeepLabCut"
    found = load_dataset(path, source_software=software)
    order = ("time", "individuals", "keypoints")
    positions = found.position.transpose(*order, "space").to_numpy()
    likelihoods = found.confidence.transpose(*order).to_numpy()
    individuals = [str(name) for name in found.individuals.to_numpy()]
    keypoints = [str(name) for name in found.keypoints.to_numpy()]
    several = len(individuals) > 1
    names = [f"{who}:{what}" if several else what for who in individuals for what in keypoints]
    frames = len(positions)
    return {
        "positions": positions.reshape(frames, len(names), -1),
        "likelihoods": np.nan_to_num(likelihoods.reshape(frames, len(names)).astype(float)),
        "names": np.array(names),
        "fps": np.array(1.0),
    }


if __name__ == "__main__":
    main()
