"""A library of clips.

Walks, jumping jacks and punches: cut, looped and put into groups in one go; then the cycles most
like a new walk.
"""

import tempfile
from pathlib import Path

import roundelay as rl
from roundelay import synth

folder = Path(tempfile.mkdtemp())
for seed, kind in enumerate(["walk", "jacks", "punch", "walk", "jacks"]):
    clip = synth.gait(kind, repetitions=3.3, start=0.3 * seed, rng=seed).motion
    rl.write(clip, folder / f"clip{seed}_{kind}.bvh")

library = rl.build_library(folder, folder / "library", jobs=1)
for file, cycle in library.cycles:
    print(f"group {cycle['group']}: {file}, period {cycle['period_seconds']:.2f} s")

query = rl.find_cycles(synth.gait("walk", repetitions=2.5, rng=9).motion)[0]
for match in library.search(query, count=3)[0]:
    print(f"{match.distance:.3f} body sizes from {match.file}")
