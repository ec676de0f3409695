"""Behaviours of a capture.

A walk, punches and the walk again: cut into behaviours, with the same label for the same behaviour.
"""

import sys
from pathlib import Path

import roundelay as rl
from roundelay import synth
from roundelay.output import figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
walk, punch = synth.gait("walk", repetitions=5.0), synth.gait("punch", repetitions=5.0)
made = synth.sequence(walk, punch, walk)
found = rl.segment(made.motion)
print(f"cuts at {found.cuts}, true ones at {made.cuts}")
print(found.to_csv())
figures.save(figures.timeline(found), folder / "behaviours.png")
