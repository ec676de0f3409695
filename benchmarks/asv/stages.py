"""The stages of the main job, one by one, on the bundled captures."""

from __future__ import annotations

import os
import tempfile
import warnings
from pathlib import Path

import numpy as np

import roundelay as rl

# Times are of one core.
os.environ.setdefault("OMP_NUM_THREADS", "1")
CAPTURES = Path(__file__).resolve().parents[2] / "data" / "captures"


class Take:
    """A bundled capture from file to loops."""

    params = ("01_01", "01_03", "Boxing_Toes")
    param_names = ("capture",)
    timeout = 300

    def setup(self, name: str) -> None:
        """Read what the stages begin with."""
        warnings.simplefilter("ignore")
        self.path = CAPTURES / f"{name}.bvh"
        self.motion = rl.read(self.path)
        self.timeline = rl.understand(self.motion)

    def time_read(self, name: str) -> None:
        """From the file to a motion."""
        rl.read(self.path)

    def time_understand(self, name: str) -> None:
        """From a motion to its timeline."""
        rl.understand(self.motion)

    def time_segment(self, name: str) -> None:
        """From a timeline to segments."""
        rl.segment(self.motion, timeline=self.timeline)

    def peakmem_understand(self, name: str) -> None:
        """Memory of the timeline."""
        rl.understand(self.motion)


class Loops:
    """The loops of ten forward jumps."""

    def setup(self) -> None:
        """Make them once."""
        self.motion = rl.read(CAPTURES / "01_01.bvh")
        self.loops = rl.make_loops(self.motion)
        self.folder = tempfile.TemporaryDirectory()

    def teardown(self) -> None:
        """Remove what was written."""
        self.folder.cleanup()

    def time_make(self) -> None:
        """From a motion to loops with verdict."""
        rl.make_loops(self.motion)

    def time_write(self) -> None:
        """From a loop to a GLB."""
        self.loops[0].write(Path(self.folder.name) / "loop.glb")


class Topology:
    """Persistent cohomology of a noisy curve in space."""

    params = (500, 2000)
    param_names = ("points",)

    def setup(self, count: int) -> None:
        """Make the cloud."""
        rng = np.random.default_rng(0)
        angle = rng.uniform(0.0, 2.0 * np.pi, count)
        curve = np.stack([np.cos(angle), np.sin(angle), np.sin(2.0 * angle)], axis=1)
        self.cloud = curve + 0.05 * rng.standard_normal(curve.shape)

    def time_bars(self, count: int) -> None:
        """The barcode, exact."""
        rl.topology.persistent_cohomology(self.cloud)
