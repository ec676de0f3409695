"""Cycle models: how phased poses become a closed curve. One file a model; see `CycleModel`."""

from roundelay.base.registry import Registry
from roundelay.cycles.models.automatic import Automatic
from roundelay.cycles.models.centroid import Centroid
from roundelay.cycles.models.model import CycleModel
from roundelay.cycles.models.regression import Harmonic
from roundelay.cycles.models.take import Take
from roundelay.cycles.models.weighted import Paper

__all__ = ["CycleModel", "cycle_models"]

cycle_models: Registry[CycleModel] = Registry("cycle model", "roundelay.cycle_models", CycleModel)
cycle_models.add(Automatic())
cycle_models.add(Harmonic())
cycle_models.add(Take())
cycle_models.add(Centroid())
cycle_models.add(Paper())
