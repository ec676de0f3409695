"""Evidence: what topology measures of a behaviour, class and phase.

The poses of one motion, with their velocities, form a closed curve if it is periodic. Its
barcode says whether there is one loop and no other; its circular coordinate, over time, whether
the motion runs around it again and again ([A] 4.2, 4.6).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import LiftError, NoPeriod, TooShort
from roundelay.base.numeric import TINY
from roundelay.base.spans import Spans
from roundelay.phase.period import return_period
from roundelay.phase.phase_map import phase_map
from roundelay.phase.unwrap import unwrap
from roundelay.timeline.behaviours import Behaviour
from roundelay.timeline.cloud import PoseCloud, make_cloud
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import EVIDENCE
from roundelay.topology.coordinate import CircularCoordinate, circular_coordinate
from roundelay.topology.rips import Barcode

__all__ = [
    "Evidence",
    "class_coordinate",
    "follow",
    "measure",
    "measure_closed",
    "passages_of",
    "turns_of",
]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Evidence:
    """What was measured of one motion.

    Attributes
    ----------
    runs : Spans
        The frames that show it.
    turns : (F,) ndarray
        Unwrapped circular coordinate of every frame, in turns; NaN outside the runs.
    period : float
        Frames of one turn (median time of return).
    barcode : Barcode
        Degree-1 bars of the cloud of poses with velocities, in body sizes.
    coordinate : CircularCoordinate
        Of the landmarks.
    net, total : float
        Turns forward minus backward, and their sum.
    cloud : PoseCloud or None
        The points behind it, for following other classes.
    companions : tuple of int
        Other classes whose coordinates turn along: of ten jumps one may be unlike the others,
        and one class counts ten, another nine.
    closed : bool
        The frames are one period whose ends meet; `turns` is their phase in time.
    behaviour : Behaviour or None
        Of the take's timeline: what it is evidence of.
    aligned : bool
        `turns` are of the repetitions' alignment, since no class of the barcode goes around with
        them.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> evidence = rl.find_periodic(walk)[0]
    >>> round(evidence.period, 2), round(evidence.repetitions)
    (66.0, 6)
    """

    runs: Spans
    turns: Array = field(repr=False)
    period: float
    barcode: Barcode = field(repr=False)
    coordinate: CircularCoordinate = field(repr=False)
    net: float
    total: float
    cloud: PoseCloud | None = field(default=None, repr=False)
    companions: tuple[int, ...] = ()
    closed: bool = False
    behaviour: Behaviour | None = field(default=None, repr=False)
    aligned: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "runs", Spans(self.runs))

    @property
    def repetitions(self) -> float:
        """How many periods were seen, parts of one counted by time ([C] tables A)."""
        if self.closed:
            return 1.0
        if self.behaviour is not None:
            return self.behaviour.repetitions
        phase = phase_map(self.turns, self.runs)
        return float(sum(np.diff(phase(self.turns[[a, b - 1]]))[0] for a, b in self.runs))

    @property
    def prominence(self) -> float:
        """Length of the class's bar over the longest other one; infinite without another.

        Companions do not count: they tell of the same motion.
        """
        lengths = self.barcode.persistence
        others = np.delete(lengths, [self.coordinate.class_index, *self.companions])
        longest = float(others.max(initial=0.0))
        own = float(lengths[self.coordinate.class_index])
        return own / longest if longest > 0.0 else float("inf")

    @property
    def steadiness(self) -> float:
        """Net turns over all turns: 1 if the coordinate never runs backwards."""
        return self.net / max(self.total, TINY)

    @property
    def confidence(self) -> float | None:
        """The probability that the motion repeats, in [0, 1]; None where nothing is seen twice."""
        return None if self.behaviour is None else self.behaviour.probability

    @property
    def partial(self) -> tuple[str, ...]:
        """The limbs that repeat, where others that move do not; else empty."""
        whole = self.behaviour is None or self.behaviour.whole
        return () if whole else self.behaviour.limbs  # type: ignore[union-attr]


def measure(search: Search, behaviour: Behaviour, class_index: int | None = None) -> Evidence:
    """Compute the barcode of a behaviour's frames, and follow the class that is its phase.

    That is the first of the longest bars whose coordinate turns once a repetition; where none
    does, the alignment of the repetitions is the phase.

    Parameters
    ----------
    search : Search
    behaviour : Behaviour
        Cyclic.
    class_index : int, optional
        Follow this class, whatever it does.

    Raises
    ------
    NoPeriod
        If the cloud has no loop, or the coordinate of the class chosen does not turn.
    """
    own = search if behaviour.whole else search.of(behaviour.joints)
    cloud = make_cloud(own, behaviour.spans, behaviour.period * search.fps)
    frames, scale = len(search.points), search.options.topology.scale
    if class_index is not None or scale is not None:
        found = follow(cloud, class_index or 0, scale=scale, n_frames=frames)
    else:
        found = _phased(cloud, behaviour, frames)
    companions = tuple(_companions(found, cloud))
    return replace(found, companions=companions, behaviour=behaviour)


def _phased(cloud: PoseCloud, behaviour: Behaviour, frames: int) -> Evidence:
    """Follow the first class that turns with the repetitions; else take their alignment."""
    first: Evidence | None = None
    for index in range(min(EVIDENCE.classes, len(cloud.barcode))):
        with suppress(NoPeriod):
            found = follow(cloud, index, n_frames=frames)
            first = first or found
            if _turns_with(found, behaviour):
                return found
    if first is None:
        first = follow(cloud, 0, n_frames=frames)
    turns = passages_of(behaviour, frames)
    runs = behaviour.spans
    moved = sum(float(turns[b - 1] - turns[a]) for a, b in runs)
    return replace(
        first, turns=turns, period=_turn_time(turns, runs), net=moved, total=moved, aligned=True
    )


def _turns_with(found: Evidence, behaviour: Behaviour) -> bool:
    """Tell whether a coordinate runs steadily, and turns once a repetition."""
    apart = abs(np.log(max(found.net, TINY) / behaviour.repetitions))
    return bool(apart < np.log1p(EVIDENCE.turns) and found.steadiness >= EVIDENCE.steady)


def _turn_time(turns: Array, runs: Spans) -> float:
    """Return the frames of a turn, also where runs go around the circle only together.

    Raises
    ------
    TooShort
        If they do not.
    """
    try:
        return return_period(turns, runs)
    except TooShort:
        return phase_map(turns, runs).period


def passages_of(behaviour: Behaviour, frames: int) -> Array:
    """Return the turns (F,) of every frame of a behaviour by the alignment of its repetitions.

    Parameters
    ----------
    behaviour : Behaviour
    frames : int
        Of the take.
    """
    count = behaviour.passages.shape[1]
    flat = behaviour.passages.ravel()
    turn = (np.arange(len(flat)) + 0.5) / count
    known = np.isfinite(flat)
    turns = np.full(frames, np.nan)
    for start, stop in behaviour.spans:
        own = known & (flat >= start - 0.5) & (flat < stop + 0.5)
        turns[start:stop] = _interpolated(np.arange(start, stop), flat[own], turn[own])
    return turns


def measure_closed(search: Search, behaviour: Behaviour) -> Evidence:
    """Take frames for one closed period, in which time itself is the phase.

    Parameters
    ----------
    search : Search
    behaviour : Behaviour
        Closed.

    Returns
    -------
    Evidence
        With `closed` set, and one repetition.

    Raises
    ------
    NoPeriod
        If the poses form no loop.
    """
    run, options = behaviour.spans[0], search.options.topology
    poses = search.points[slice(*run)]
    cloud = make_cloud(search, Spans([run]), float(len(poses)))
    coordinate = class_coordinate(cloud, options.class_index or 0, options.scale)
    # The way from the last frame to the first takes its share of a frame: none if it repeats it.
    steps = np.linalg.norm(np.diff(poses, axis=0)[[0, -1]], axis=1)
    gap = float(np.linalg.norm(poses[-1] - poses[0]))
    period = len(poses) - 1 + min(1.0, gap / max(0.5 * float(steps.sum()), TINY))
    turns = np.full(len(search.points), np.nan)
    turns[slice(*run)] = np.arange(len(poses)) / period
    found = Evidence(cloud.runs, turns, period, cloud.barcode, coordinate, 1.0, 1.0, cloud=cloud)
    return replace(found, closed=True, behaviour=behaviour)


def _companions(evidence: Evidence, cloud: PoseCloud) -> Iterator[int]:
    """List classes that live nearly as long and turn nearly as often, as steadily."""
    lengths, own = cloud.barcode.persistence, evidence.coordinate.class_index
    if evidence.net < EVIDENCE.often:
        return
    for other in np.flatnonzero(lengths > lengths[own] / EVIDENCE.nearly).tolist():
        if other == own:
            continue
        with suppress(NoPeriod):
            along = follow(cloud, other, n_frames=len(evidence.turns))
            often = along.net * EVIDENCE.nearly > evidence.net
            if often and along.steadiness >= EVIDENCE.steady:
                yield other


def follow(
    cloud: PoseCloud, class_index: int, *, scale: float | None = None, n_frames: int
) -> Evidence:
    """Follow the circular coordinate of one class over time.

    Parameters
    ----------
    cloud : PoseCloud
    class_index : int
        Which bar, 0 being the longest.
    scale : float, optional
        Of the coordinate; automatic by default.
    n_frames : int
        Length of the capture.

    Returns
    -------
    Evidence

    Raises
    ------
    NoPeriod
        If there is no such class, it lifts to no integer cocycle, or its coordinate makes no turn.
    """
    coordinate = class_coordinate(cloud, class_index, scale)
    spread, turns = turns_of(cloud, coordinate, n_frames)
    moved = np.concatenate([np.diff(turns[a:b]) for a, b in cloud.local])
    net, total = float(moved.sum()), float(np.abs(moved).sum())
    try:
        period = _turn_time(spread, cloud.runs)
    except TooShort as error:
        raise NoPeriod(str(error), cloud.barcode) from None
    return Evidence(cloud.runs, spread, period, cloud.barcode, coordinate, net, total, cloud=cloud)


def class_coordinate(
    cloud: PoseCloud, class_index: int, scale: float | None = None
) -> CircularCoordinate:
    """Return the circular coordinate of one class of a cloud; arguments as for `follow`.

    Raises
    ------
    NoPeriod
        If there is no such class, or it lifts to no integer cocycle.
    """
    barcode = cloud.barcode
    if len(barcode) <= class_index:
        absent = f", none of them class {class_index}" if class_index else ""
        loops = f"{len(barcode)} loop" + ("" if len(barcode) == 1 else "s")
        raise NoPeriod(f"the poses form {loops}{absent}", barcode)
    try:
        return circular_coordinate(barcode, k=class_index, scale=scale, runs=cloud.landmark_runs)
    except LiftError as error:
        raise NoPeriod(str(error), barcode) from error


def turns_of(
    cloud: PoseCloud, coordinate: CircularCoordinate, n_frames: int
) -> tuple[Array, Array]:
    """Unwrap a coordinate over time, so that it runs forward on the whole.

    Parameters
    ----------
    cloud : PoseCloud
    coordinate : CircularCoordinate
        Of the cloud's landmarks.
    n_frames : int
        Length of the capture.

    Returns
    -------
    (n_frames,) ndarray
        Turns of every frame; NaN outside the runs.
    (m,) ndarray
        Turns of the cloud's frames.
    """
    phase, local = cloud.extended(coordinate), cloud.local
    turns = unwrap(phase, local)
    if sum(turns[b - 1] - turns[a] for a, b in local) < 0.0:
        turns = unwrap(-phase, local)
    spread = np.full(n_frames, np.nan)
    for (start, stop), (a, b) in zip(cloud.runs, local, strict=True):
        inside = np.arange(start, stop)
        spread[start:stop] = _interpolated(inside, cloud.frames[a:b], turns[a:b])
    return spread, turns


def _interpolated(frames: Indices, known: Array | Indices, values: Array) -> Array:
    """Interpolate linearly, and go on with the end slopes beyond the known frames."""
    if len(known) < 2:
        return np.full(len(frames), float(values[0]))
    first = (values[1] - values[0]) / (known[1] - known[0])
    last = (values[-1] - values[-2]) / (known[-1] - known[-2])
    before, beyond = np.minimum(frames - known[0], 0), np.maximum(frames - known[-1], 0)
    return np.interp(frames, known, values) + first * before + last * beyond
