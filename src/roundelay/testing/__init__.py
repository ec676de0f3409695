"""Checks that every reader, writer, proposer, model, method and profile must pass, ours and yours.

Each takes an object, uses it as roundelay does, and raises AssertionError that says what was
expected and what was found. They need no test framework, and no registration.
"""

from roundelay.testing.cycle_models import check_cycle_model
from roundelay.testing.profiles import check_profile
from roundelay.testing.proposers import check_proposer
from roundelay.testing.readers import check_reader
from roundelay.testing.segmentation_methods import check_segmentation_method
from roundelay.testing.writers import check_writer

__all__ = [
    "check_cycle_model",
    "check_profile",
    "check_proposer",
    "check_reader",
    "check_segmentation_method",
    "check_writer",
]
