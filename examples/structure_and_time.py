"""Structure and time.

The circular coordinate runs fast where poses change fast. Its density ([A] figure 3), and four
maps of it over time ([C] figures 3.2 to 3.5): only the speed of traversal is not misled by a
capture that ends in the middle of a period.
"""

import sys
from pathlib import Path

import roundelay as rl
from roundelay import synth
from roundelay.output import figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
made = synth.gait("punch", repetitions=2.5, rng=3)
cycle = rl.find_cycles(made.motion)[0]

drawn = figures.new_figure(12.0, 3.6)
figures.density(cycle.evidence, axes=drawn.add_subplot(1, 3, 1))
figures.circle_density(cycle.evidence, axes=drawn.add_subplot(1, 3, 2, projection="polar"))
figures.period_line(cycle.evidence, made.motion, axes=drawn.add_subplot(1, 3, 3))
figures.save(drawn, folder / "structure_and_time_1.png")
figures.save(figures.remaps(made.motion, cycle.evidence), folder / "structure_and_time_2.png")
