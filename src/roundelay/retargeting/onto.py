"""Retarget a motion: the same movement on another body."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import expected
from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import TINY
from roundelay.base.threads import one_thread
from roundelay.cycles.captured import as_shown
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models.regression import fit_cycle
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.loops.lint import taken_apart
from roundelay.loops.mend import continued
from roundelay.loops.thresholds import LINT
from roundelay.motion.motion import Motion, concatenate
from roundelay.retargeting.anatomy import Anatomy
from roundelay.retargeting.carrying import carried, seen
from roundelay.retargeting.finding import named_body
from roundelay.retargeting.mapping import BodyMap, unlike
from roundelay.retargeting.reference import Reference, reference_of, upright
from roundelay.retargeting.standing import ground_of, put_on_ground
from roundelay.retargeting.thresholds import FINDING
from roundelay.retargeting.touching import keep_touches, touches_of

__all__ = ["Retargeting", "as_played", "map_body", "retarget"]

Array = NDArray[np.float64]
Moving = TypeVar("Moving", Motion, Cycle)


def map_body(character: Motion | Skeleton) -> BodyMap:
    """Find the canonical body on a skeleton, by the names, the tree and the poses of its joints.

    Parameters
    ----------
    character : Motion or Skeleton

    Returns
    -------
    BodyMap
        To be used as it is, or edited.

    Raises
    ------
    SkeletonMismatch
        If limbs are missing, or two fit equally well.

    Examples
    --------
    >>> body = rl.map_body(rl.read("walk.bvh"))
    >>> body.kind
    'biped'
    >>> body.joints["left foot"]
    'LeftFoot'
    """
    skeleton, motion = _parts(character)
    body, tailed = named_body(skeleton)
    if body.kind == "quadruped" or not _on_all_fours(skeleton, body, motion, tailed=tailed):
        return body
    return named_body(skeleton, "quadruped")[0]


def _parts(character: Motion | Skeleton) -> tuple[Skeleton, Motion | None]:
    motion = character if isinstance(character, Motion) else None
    skeleton = expected(Skeleton, character) if motion is None else motion.skeleton
    if skeleton.free:
        told = "expected a skeleton with bones, found markers or keypoints"
        raise SkeletonMismatch(f"{told}; solve one first (roundelay convert, or rl.solve_skeleton)")
    return skeleton, motion


def _on_all_fours(
    skeleton: Skeleton, body: BodyMap, motion: Motion | None, *, tailed: bool
) -> bool:
    """Tell a quadruped whose limbs are called arms and legs: its trunk is level, or has a tail."""
    anatomy = Anatomy(skeleton, body)
    poses = [rot.identity(skeleton.n_joints), *([] if skeleton.rest is None else [skeleton.rest])]
    if any(upright(anatomy, pose)[0] is not None for pose in poses):
        return False
    if not tailed or motion is None:
        return tailed
    places = motion.at(
        np.unique(np.linspace(0, len(motion) - 1, FINDING.frames).round())
    ).positions()
    ends = (places[:, list(pair)].mean(axis=1) for pair in (anatomy.shoulders, anatomy.hips))
    trunk = next(ends) - next(ends)
    steep = np.abs(trunk[:, motion.up]) / np.maximum(np.linalg.norm(trunk, axis=1), TINY)
    return bool(np.median(steep) < FINDING.level)


@dataclass(frozen=True, eq=False)
class Retargeting:
    """What carries motions of one skeleton onto another; made once, for any number of them.

    Attributes
    ----------
    source, target : Anatomy
    learned, own : Reference
        How their joints' axes stand to their bodies.
    up : {0, 1, 2}
        The axis that points up in the target's world.
    """

    source: Anatomy
    target: Anatomy
    learned: Reference
    own: Reference
    up: int

    @classmethod
    def between(
        cls,
        motion: Motion,
        character: Motion | Skeleton,
        *,
        source_map: BodyMap | None = None,
        target_map: BodyMap | None = None,
    ) -> Retargeting:
        """Prepare what carries a motion onto a character; see `retarget`."""
        skeleton, shown = _parts(character)
        _parts(motion)
        ours = map_body(motion) if source_map is None else source_map
        theirs = map_body(character) if target_map is None else target_map
        fault = unlike(ours, theirs)
        if fault is not None:
            raise fault
        source, target = Anatomy(motion.skeleton, ours), Anatomy(skeleton, theirs)
        own = reference_of(target, shown)
        up = own.up if shown is None or len(shown) < 3 else shown.up
        return cls(source, target, reference_of(source, motion), own, 1 if up is None else up)

    @property
    def maps(self) -> dict[str, BodyMap]:
        """Which joints are which, of the "capture" and of the "character"."""
        return {"capture": self.source.body, "character": self.target.body}

    def __call__(self, motion: Motion) -> Motion:
        """Carry a motion over; one that is a loop, as the loop that it is.

        Raises
        ------
        SkeletonMismatch
            If it is of another skeleton.
        """
        motion.skeleton.require_same(self.source.skeleton)
        count = _loop_of(motion)
        if not count:
            return self._carried(motion)
        # Feet that stand across the seam are held by the periods around.
        around = _around(motion[:count], count)
        beside = around[count + len(motion) :]
        whole = self._carried(concatenate([around[:count], motion, beside]))
        return whole[count : count + len(motion)]

    def cycle(self, cycle: Cycle) -> Cycle:
        """Carry a cycle over, with the periods around it; it has no evidence of a capture.

        Raises
        ------
        SkeletonMismatch
            If it is of another skeleton.
        """
        cycle.skeleton.require_same(self.source.skeleton)
        count = max(LINT.shortest, round(cycle.period * cycle.fps))
        phase = np.arange(-count, 2 * count) / count
        moved = self._carried(cycle.at(phase, frame_time=cycle.period / count))
        runs, harmonics = [(0, 3 * count)], (count - 1) // 2
        made = fit_cycle(moved.with_root_motion(), phase, runs, harmonics=harmonics)
        made = replace(made, name=cycle.name, fps=cycle.fps)
        return as_shown(made, moved, phase)

    def _carried(self, motion: Motion) -> Motion:
        axes = rot.multiply(rot.conjugate(rot.axis_to_y(self.up)), rot.axis_to_y(motion.up))
        source = seen(motion, self.source, self.learned, axes)
        pose = carried(source, self.target, self.own)
        ground = ground_of(source, self.source, self.learned, motion.fps, self.up)
        path = put_on_ground(
            pose, source, self.source, self.learned.stands, ground, motion.fps, self.up
        )
        keep_touches(pose, touches_of(source, self.source, motion.fps), path)
        rotations, _, _ = pose.solved(path)
        return Motion(
            self.target.skeleton,
            rotations,
            path,
            motion.frame_time,
            name=motion.name,
            up=self.up,
        )


def _loop_of(motion: Motion) -> int:
    """Return the frames of the periods that a motion is; 0 if it is no loop without a fault."""
    if len(motion) < LINT.shortest:
        return 0
    apart = taken_apart(motion, False)
    period = apart.period
    if period.missing or not apart.recognised or len(motion) - period.count > 1:
        return 0
    return period.count


def as_played(motion: Motion, wraps: bool) -> Motion:
    """Return a loop with its first frame repeated at its end, or not; what is no loop as it is.

    Parameters
    ----------
    motion : Motion
    wraps : bool
        Whether players of its format go from the last frame to the first without any time between;
        see `roundelay.formats.wraps_at_last_key`.
    """
    count = _loop_of(motion)
    if not count:
        return motion
    return continued(motion[:count], 1) if wraps else motion[:count]


def _around(motion: Motion, count: int) -> Motion:
    """Return a period with the one before it and the one behind it, itself where it was."""
    thrice = continued(continued(motion, count), count)
    turn = rot.multiply(thrice.rotations[count, 0], rot.conjugate(thrice.rotations[0, 0]))
    back = rot.conjugate(turn)
    turned = thrice.turned(back)
    return replace(
        turned, root_path=turned.root_path + motion.root_path[0] - turned.root_path[count]
    )


@one_thread
def retarget(
    moving: Moving,
    character: Motion | Skeleton,
    *,
    source_map: BodyMap | None = None,
    target_map: BodyMap | None = None,
) -> Moving:
    """Carry a motion or a cycle over to another body.

    Bones turn as they did, whatever the poses at rest; a spine or a neck of other number shares
    the bends out. The way over the ground is as much longer as the legs are. Feet stand where and
    when they stood, and hands that touch the body touch it again. A loop stays a loop.

    Parameters
    ----------
    moving : Motion or Cycle
    character : Motion or Skeleton
        The body that it goes to, as from `roundelay.read_character`: a skeleton with a pose at rest
        in which it stands, or a motion of it.
    source_map, target_map : BodyMap, optional
        Which joints are which of the canonical body; found by default, see `map_body`.

    Returns
    -------
    Motion or Cycle
        On the character's skeleton, with its meshes, in its unit and on its axes.

    Raises
    ------
    SkeletonMismatch
        If one has no arms or legs that can be told, one is a biped and the other a quadruped, or
        no pose tells how a body stands.

    Examples
    --------
    >>> hero = rl.read_character("run.bvh")
    >>> walk = rl.retarget(rl.read("walk.bvh"), hero)
    >>> walk.skeleton.names == hero.skeleton.names
    True
    """
    shown = moving.sample(periods=2) if isinstance(moving, Cycle) else expected(Motion, moving)
    carrying = Retargeting.between(shown, character, source_map=source_map, target_map=target_map)
    return carrying.cycle(moving) if isinstance(moving, Cycle) else carrying(moving)
