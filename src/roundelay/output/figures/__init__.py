"""Pictures of results, with Matplotlib, which is imported only when one is drawn.

Each is made from a result: a `Barcode`, an `Evidence`, a `Cycle`, a `Segmentation`, a `Motion`,
`Strides`, a `Comparison`. Those that take ``axes`` draw there, or on axes of their own without, and
return them; the others return a figure. `save` writes figures, also ``axes.figure``, as PNG, SVG or
PDF by the suffix.
"""

from roundelay.output.figures.comparison import comparison, coordination, curves, difference
from roundelay.output.figures.excitation import excitations
from roundelay.output.figures.gait import stances, steps, stride_line
from roundelay.output.figures.inspection import inspection, persistence_diagram
from roundelay.output.figures.overview import barcode, coordinate, overview, plane
from roundelay.output.figures.phase import circle_density, density, period_line, remaps
from roundelay.output.figures.poses import animation, strip
from roundelay.output.figures.style import new_figure, save
from roundelay.output.figures.timeline import behaviours, method_curve, timeline
from roundelay.output.figures.trajectory import angles, typical_trajectory

__all__ = [
    "angles",
    "animation",
    "barcode",
    "behaviours",
    "circle_density",
    "comparison",
    "coordinate",
    "coordination",
    "curves",
    "density",
    "difference",
    "excitations",
    "inspection",
    "method_curve",
    "new_figure",
    "overview",
    "period_line",
    "persistence_diagram",
    "plane",
    "remaps",
    "save",
    "stances",
    "steps",
    "stride_line",
    "strip",
    "timeline",
    "typical_trajectory",
]
