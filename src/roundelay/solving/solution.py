"""From points to a motion: a skeleton solved from markers or keypoints.

::

    Points -> metres, Y up -> landmarks -> joint centres -> first guess of shape and poses
           -> shape and poses of some frames at once -> poses of all frames -> Motion
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import expected
from roundelay.base.errors import RoundelayWarning, TooShort, Unsolvable
from roundelay.base.progress import Progress, report
from roundelay.base.threads import one_thread
from roundelay.motion.gaps import outliers
from roundelay.motion.motion import Motion
from roundelay.motion.point_sets import known_set
from roundelay.motion.points import Points
from roundelay.motion.poses import Mask
from roundelay.motion.thresholds import GAPS
from roundelay.solving.body import Poses
from roundelay.solving.bridging import averaged, bridged, told
from roundelay.solving.centres import centres_of_keypoints, centres_of_markers
from roundelay.solving.equations import Targets, marker_places
from roundelay.solving.fitting import fitted_poses, fitted_shape
from roundelay.solving.landmarks import KEYPOINT_SETS, computed, landmarks_of
from roundelay.solving.person import Guess, guessed_person
from roundelay.solving.placing import Placement, placement_of_body, placement_of_person
from roundelay.solving.rigid import guessed_bones
from roundelay.solving.smoothing import measured_noise, smooth_poses
from roundelay.solving.standing import standing_feet
from roundelay.solving.thresholds import FITTING, SHAPES, SMOOTHING, STANDING

__all__ = ["Solution", "solve", "solve_skeleton"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solution:
    """Hold a motion solved from points, and how well it explains them.

    Attributes
    ----------
    motion : Motion
        Of the frames in which the body is seen; in the points' unit and world.
    frames : (int, int)
        Those frames among the points', half open.
    markers : tuple of str
        The points that were used.
    joints : tuple of str
        The joint on whose bone each of them is.
    residuals : (F, M) ndarray
        Distance of each from its place on the bone, in the points' unit; NaN where not seen.
    left_out : tuple of str
        Points that are on no bone, or hardly seen.
    noise : float
        Standard deviation of a coordinate, as measured, in the points' unit.

    Examples
    --------
    >>> from roundelay.solving import solve
    >>> found = solve(rl.read_points("keypoints.trc"))
    >>> found.residuals.shape
    (429, 12)
    """

    motion: Motion
    frames: tuple[int, int]
    markers: tuple[str, ...]
    joints: tuple[str, ...]
    residuals: Array = field(repr=False)
    left_out: tuple[str, ...]
    noise: float

    __repr__ = brief

    @property
    def rms(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.nanmean(self.residuals**2)))


def solve_skeleton(points: Points, *, progress: Progress | None = None) -> Motion:
    """Solve a skeleton with turning bones from markers or keypoints; see `solve` for how well.

    Parameters
    ----------
    points : Points
        In three dimensions: of a person by the names of the known sets, or any markers, three or
        more on each bone.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    Motion
        Of the frames in which the body is seen; what is left out is told by a warning.

    Raises
    ------
    Unsolvable
        If the points tell no skeleton; the message says what is missing.
    TooShort
        If there are fewer than 8 frames in which the body is seen.
    Cancelled
        If `progress` returned False.

    Examples
    --------
    >>> motion = rl.solve_skeleton(rl.read_points("keypoints.trc"))
    >>> len(motion), motion.skeleton.n_joints
    (429, 16)
    """
    solved = solve(points, progress=progress)
    start, stop = solved.frames
    notes = []
    if solved.left_out:
        notes.append(f"points on no bone or hardly seen: {_listed(solved.left_out)}")
    if stop - start < len(points):
        notes.append(f"frames in which the body is not seen: all but {start + 1}-{stop}")
    if notes:
        warnings.warn(RoundelayWarning(f"left out, {'; '.join(notes)}"), stacklevel=2)
    return solved.motion


def _listed(names: tuple[str, ...]) -> str:
    more = f" and {len(names) - 5} others" if len(names) > 5 else ""
    return ", ".join(names[:5]) + more


@one_thread
def solve(points: Points, *, progress: Progress | None = None) -> Solution:
    """Solve a skeleton from points, and say how well it explains them.

    Parameters, errors as of `solve_skeleton`.

    Returns
    -------
    Solution
    """
    whole = expected(Points, points)
    report(progress, 0.0, "choosing markers")
    points, start = _chosen(whole)
    guess, placement, keypoints = _guessed(points)
    positions, seen = placement.into(points.positions), _sound(points, placement)
    spread = SHAPES.keypoint if keypoints else SHAPES.skin
    report(progress, 1 / 8, "fitting bones")
    guess, targets = _shaped(guess, positions, seen, spread)
    strays = _strays(guess, positions, seen)
    if strays.any() and not keypoints:
        guess, targets = _shaped(_without(guess, strays), positions, seen, spread)
    report(progress, 0.5, "fitting poses")
    used = guess.points
    noise = measured_noise(positions[:, used], seen[:, used])
    poses = _posed(guess, targets, points.fps, noise, spread)
    apart = np.linalg.norm(marker_places(guess.body, poses) - positions[:, used], axis=2)
    apart[~seen[:, used]] = np.nan
    report(progress, 1.0, "done")
    markers = tuple(points.names[point] for point in used)
    return Solution(
        placement.motion(guess.body, poses, points),
        (start, start + len(points)),
        markers,
        tuple(guess.body.names[joint] for joint in guess.body.joints),
        apart / placement.scale,
        tuple(name for name in whole.names if name not in markers and not computed(name)),
        noise / placement.scale,
    )


def _chosen(points: Points) -> tuple[Points, int]:
    """Return the points that can be used, in the frames in which the body is seen, and the first.

    Raises
    ------
    Unsolvable
        If they lie in a plane.
    TooShort
        If there are too few frames.
    """
    if points.dimensions != 3:
        raise Unsolvable("expected points in 3 dimensions, found 2; " + _INSTEAD)
    seen = points.seen.copy()
    if points.likelihoods is not None:
        seen &= points.likelihoods >= GAPS.likely
    marks = landmarks_of(points.names)
    core = np.array([mark is not None for mark in marks])
    share = seen[:, core if core.any() else slice(None)].mean(axis=1)
    there = np.flatnonzero(share >= SHAPES.present * share.max(initial=0.0))
    if not len(there) or not share.max() > 0.0:
        raise TooShort("expected frames in which points are seen, found none")
    start, stop = int(there[0]), int(there[-1]) + 1
    if stop - start < SHAPES.fewest:
        asked = f"at least {SHAPES.fewest} frames in which the body is seen"
        raise TooShort(f"expected {asked}, found {stop - start}")
    often = seen[start:stop].mean(axis=0) >= SHAPES.seen
    names = [
        name
        for name, mark, enough in zip(points.names, marks, often, strict=True)
        if enough and not (mark is None and computed(name))
    ]
    if not 3 <= len(names) <= SHAPES.most:
        asked = f"3 to {SHAPES.most} points seen in {SHAPES.seen:.0%} of the frames"
        raise Unsolvable(f"expected {asked}, found {len(names)}; {_INSTEAD}")
    return replace(points, missing=~seen)[start:stop].select(names), start


_INSTEAD = (
    "loops can be made of the points themselves, and `roundelay convert --points` writes those"
)


def _guessed(points: Points) -> tuple[Guess, Placement, bool]:
    """Return a first guess, where it is, and whether points are joint centres.

    Raises
    ------
    Unsolvable
        If points are neither those of a person nor three a bone.
    """
    one = known_set(points.names)
    keypoints = one is not None and one.name in KEYPOINT_SETS
    marks = landmarks_of(points.names)
    placement = placement_of_person(points, marks)
    lacking = "named markers of hips and legs"
    if placement is not None:
        positions, seen = placement.into(points.positions), _sound(points, placement)
        try:
            find = centres_of_keypoints if keypoints else centres_of_markers
            centres = find(positions, seen, marks)
            guess = guessed_person(positions, seen, marks, centres, keypoints=keypoints)
        except Unsolvable as error:
            lacking = str(error)
        else:
            return guess, placement, keypoints
    placement = placement_of_body(points)
    try:
        guess = guessed_bones(placement.into(points.positions), _sound(points, placement))
    except Unsolvable as error:
        message = f"no skeleton: a person needs {lacking}, any other body {error}; {_INSTEAD}"
        raise Unsolvable(message) from None
    return guess, placement, False


def _sound(points: Points, placement: Placement) -> Mask:
    """Return what was seen (F, N), without what jumps away and back."""
    positions = placement.into(points.positions)
    return points.seen & ~outliers(positions, points.seen, SHAPES.person)


def _shaped(guess: Guess, positions: Array, seen: Mask, spread: float) -> tuple[Guess, Targets]:
    """Fit the shape to some frames that show much, spread over the take."""
    used = guess.points
    targets = Targets(positions[:, used], seen[:, used] / spread**2)
    count = seen[:, used].sum(axis=1)
    full = np.flatnonzero(count >= np.median(count))
    few = full[np.unique(np.linspace(0, len(full) - 1, SHAPES.frames).round().astype(int))]
    near = fitted_poses(guess.body, guess.poses[few], targets[few], FITTING.first_rounds)
    body, _ = fitted_shape(guess.body, near, targets[few])
    return replace(guess, body=body), targets


def _strays(guess: Guess, positions: Array, seen: Mask) -> Mask:
    """Tell which markers (M,) are far off their bones in the mean."""
    few = np.unique(np.linspace(0, len(positions) - 1, SHAPES.frames).round().astype(int))
    used = guess.points
    targets = Targets(positions[few][:, used], seen[few][:, used] / SHAPES.skin**2)
    poses = fitted_poses(guess.body, guess.poses[few], targets, FITTING.first_rounds)
    squares = np.sum((marker_places(guess.body, poses) - targets.places) ** 2, axis=2)
    weights = targets.weights > 0.0
    mean = np.sum(squares * weights, axis=0) / np.maximum(weights.sum(axis=0), 1)
    return np.asarray(mean > SHAPES.stray**2)


def _without(guess: Guess, strays: Mask) -> Guess:
    """Leave markers out.

    Raises
    ------
    Unsolvable
        If they are more than a part.
    """
    body = guess.body
    if strays.mean() > SHAPES.strays:
        asked = f"markers that stay on their bones within {100 * SHAPES.stray:g} cm of a person"
        found = f"{strays.sum()} of {len(strays)} that do not"
        raise Unsolvable(f"expected {asked}, found {found}; {_INSTEAD}")
    kept = replace(
        body,
        joints=body.joints[~strays],
        places=body.places[~strays],
        place_spread=body.place_spread[~strays],
    )
    return replace(guess, body=kept, points=guess.points[~strays])


def _posed(guess: Guess, targets: Targets, fps: float, noise: float, spread: float) -> Poses:
    """Return the poses of all frames: each by itself, then bridged, then all together."""
    body = guess.body
    calm = averaged(guess.poses.rotations, round(SMOOTHING.calm * fps))
    trust = np.full(calm.shape[:2], SMOOTHING.guess**-2)
    trust[:, 0] = 0.0
    held = replace(targets, turns=calm, trust=trust)
    poses = fitted_poses(body, Poses(guess.poses.root, calm), held, FITTING.first_rounds)
    poses = Poses(poses.root, bridged(poses.rotations, told(body, poses, targets, fps)))
    share = noise / spread
    poses = smooth_poses(body, poses, targets, fps=fps, share=share)
    if noise > STANDING.noise:
        firm = standing_feet(body, poses, targets, fps=fps)
        poses = smooth_poses(body, poses, firm, fps=fps, share=share)
    return poses
