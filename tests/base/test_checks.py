"""A wrong type is named at the door, in the project's own words."""

from __future__ import annotations

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth, topology

MOTION = synth.gait("walk").motion
TABLE = np.zeros((100, 5))

WRONG = {
    "find_cycles": (lambda: rl.find_cycles(TABLE), "a Motion, found ndarray"),
    "find_periodic": (lambda: rl.find_periodic(TABLE), "a Motion or Poses, found ndarray"),
    "options": (lambda: rl.find_cycles(MOTION, {"joints": 3}), "an Options, found dict"),
    "searched": (lambda: rl.find_periodic(MOTION, "fast"), "an Options, found str"),
    "empty options": (lambda: rl.find_cycles(MOTION, {}), "an Options, found dict"),
    "understood": (lambda: rl.understand(TABLE), "a Motion or Poses, found ndarray"),
    "make_cycle": (lambda: rl.make_cycle(MOTION, None), "an Evidence, found NoneType"),
    "segment": (lambda: rl.segment(TABLE), "a Motion, found ndarray"),
    "quality": (lambda: rl.quality(MOTION, MOTION), "a Cycle, found Motion"),
    "concatenate": (lambda: rl.concatenate([MOTION, TABLE]), "a Motion, found ndarray"),
    "write": (lambda: rl.write(TABLE, "table.bvh"), "a Motion, found ndarray"),
    "blend": (lambda: rl.blend([MOTION], [1.0]), "a Cycle, found Motion"),
    "coordinate": (lambda: topology.circular_coordinate(TABLE), "a Barcode, found ndarray"),
}


@pytest.mark.parametrize("door", WRONG)
def test_the_wrong_type_is_named(door):
    work, message = WRONG[door]
    with pytest.raises(TypeError, match=f"^expected {message}$"):
        work()
