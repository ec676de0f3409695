"""Pictures of results, with Matplotlib, which is imported only when one is drawn."""

from roundelay.figures.inspection import inspection, persistence_diagram
from roundelay.figures.overview import barcode, coordinate, overview, plane, save

__all__ = [
    "barcode",
    "coordinate",
    "inspection",
    "overview",
    "persistence_diagram",
    "plane",
    "save",
]
