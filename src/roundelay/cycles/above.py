"""What the joints above the hips did: a bone for root motion, a root that stands still.

A cycle holds the body's motion in the root, wherever it was in the capture
(`roundelay.Motion.with_root_motion`). `Above` tells what the joints there really did, so that a
loop can give each of them its own again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.numeric import ROUNDING
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.symmetry import reflected_rotations, reflection
from roundelay.motion.motion import Motion

__all__ = ["Above"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Above:
    """Joints from the root down to the one that carried the body, that one left out.

    Parameters
    ----------
    rotations : (n, 4) ndarray
        How each is turned in the world, the steady turning left out where it `turns`.
    places : (n, 3) ndarray
        Where each is in the world, in the skeleton's length unit; the steady path left out where
        it `travels`, turned along where it `turns`.
    travels, turns : (n,) ndarray of bool
        Whether it went and turned with the body, or stood.
    """

    rotations: Array
    places: Array
    travels: Mask
    turns: Mask

    __repr__ = brief

    def turned(self, turn: Array) -> Above:
        """Return them turned about the vertical through the origin by a rotation (4,)."""
        return replace(
            self,
            rotations=rot.multiply(turn, self.rotations),
            places=rot.rotate(turn, self.places),
        )

    def reflected(self, across: int, sideways: int) -> Above:
        """Return them in a mirror; the axes are those of `symmetry.reflected_skeleton`."""
        itself = np.zeros(1, np.intp)
        turned = reflected_rotations(self.rotations[:, None], itself, across, sideways)
        return replace(self, rotations=turned[:, 0], places=self.places * reflection(sideways))

    def given(self, motion: Motion, turn: Array, path: Array) -> Motion:
        """Return a motion with its root's motion on the joint that carried it in the capture.

        All joints from that one on keep their places in the world.

        Parameters
        ----------
        motion : Motion
            With the body's motion in the root.
        turn : (F, 4) ndarray
            The steady turning reached.
        path : (F, 3) ndarray
            The steady path, in the skeleton's length unit.

        Returns
        -------
        Motion
            Its translations are set.
        """
        chain = list(motion.skeleton.trunk[: len(self.places) + 1])
        hung, carrier = chain[1:], chain[-1:]
        body, facing = forward_kinematics(
            motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
        )
        above, where = self._world(turn, path)
        turns = np.concatenate([above, facing[:, carrier]], axis=1)
        places = np.concatenate([where, body[:, carrier]], axis=1)
        back = rot.conjugate(turns[:, :-1])
        rotations = motion.rotations.copy()
        rotations[:, 0], rotations[:, hung] = turns[:, 0], rot.multiply(back, turns[:, 1:])
        moved = rot.rotate(back, np.diff(places, axis=1))
        return replace(
            motion,
            rotations=rotations,
            root_path=places[:, 0],
            translations=_with_moved(motion, hung, moved),
        )

    def _world(self, turn: Array, path: Array) -> tuple[Array, Array]:
        """Return rotations (F, n, 4) and places (F, n, 3) of the joints in the world."""
        goes, turned = self.travels[:, None], self.turns[:, None]
        rotations = np.where(turned, rot.multiply(turn[:, None], self.rotations), self.rotations)
        places = np.where(turned, rot.rotate(turn[:, None], self.places), self.places)
        return rotations, places + np.where(goes, path[:, None], 0.0)


def _with_moved(motion: Motion, joints: list[int], moved: Array) -> Array:
    """Return translations (F, J, 3) with those of some joints; bones of one length keep it."""
    offsets = motion.skeleton.offsets
    shape = (*motion.rotations.shape[:2], 3)
    base = offsets if motion.translations is None else motion.translations
    translations = np.array(np.broadcast_to(base, shape))
    away = np.abs(moved - offsets[joints]).max(axis=(0, 2))
    still = (away < ROUNDING * motion.skeleton.size)[:, None]
    translations[:, joints] = np.where(still, offsets[joints], moved)
    return translations
