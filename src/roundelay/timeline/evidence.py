"""Evidence: what topology measures of proposed frames, for the verdict to judge.

The poses of one motion, with their velocities, form a closed curve if it is periodic. Its
barcode says whether there is one loop and no other; its circular coordinate, over time, whether
the motion runs around it again and again ([A] 4.2, 4.6).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import LiftError, NoPeriod, TooShort
from roundelay.base.numeric import TINY
from roundelay.base.spans import Span, Spans
from roundelay.phase.period import return_period
from roundelay.phase.phase_map import phase_map
from roundelay.phase.unwrap import unwrap
from roundelay.timeline.cloud import PoseCloud, make_cloud
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import EVIDENCE, VERDICT
from roundelay.topology.coordinate import CircularCoordinate, circular_coordinate
from roundelay.topology.rips import Barcode

__all__ = [
    "Evidence",
    "class_coordinate",
    "disagreement",
    "follow",
    "measure",
    "measure_closed",
    "turns_of",
    "without_pauses",
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
    limbs : str
        The limbs that show it, as `roundelay.motion.poses.Poses.groups` names them; empty for
        the whole body.
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
    limbs: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "runs", Spans(self.runs))

    @property
    def repetitions(self) -> float:
        """How many periods were seen, parts of one counted by time ([C] tables A)."""
        if self.closed:
            return 1.0
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
    def confidence(self) -> float:
        """How sure it is that the motion is periodic, in [0, 1].

        Each turn confirms that the loop's bar is no chance, the more so the longer it is
        against the next: 1 - prominence^-turns; times the share of motion that goes forwards
        (steadiness), times what was seen again (twice the turns beyond the first, at most 1;
        all of it if the ends meet).
        """
        again = 1.0 if self.closed else float(np.clip(EVIDENCE.again * (self.net - 1.0), 0.0, 1.0))
        return (1.0 - max(self.prominence, 1.0) ** -self.net) * self.steadiness * again


def measure(search: Search, runs: Spans, period: float) -> Evidence:
    """Compute the barcode of some frames and follow one class over time.

    Arguments as for `roundelay.timeline.cloud.make_cloud`.

    Raises
    ------
    NoPeriod
        If the cloud has no loop or the coordinate does not turn.
    """
    cloud, options = make_cloud(search, runs, period), search.options.topology
    frames = len(search.points)
    found = follow(cloud, options.class_index or 0, scale=options.scale, n_frames=frames)
    return replace(found, companions=tuple(_companions(found, cloud)))


def measure_closed(search: Search, run: Span) -> Evidence:
    """Take frames for one closed period, in which time itself is the phase.

    Parameters
    ----------
    search : Search
    run : (start, stop)

    Returns
    -------
    Evidence
        With `closed` set, and one repetition.

    Raises
    ------
    NoPeriod
        If the poses form no loop.
    """
    poses, options = search.points[slice(*run)], search.options.topology
    cloud = make_cloud(search, Spans([run]), float(len(poses)))
    coordinate = class_coordinate(cloud, options.class_index or 0, options.scale)
    # The way from the last frame to the first takes its share of a frame: none if it repeats it.
    steps = np.linalg.norm(np.diff(poses, axis=0)[[0, -1]], axis=1)
    gap = float(np.linalg.norm(poses[-1] - poses[0]))
    period = len(poses) - 1 + min(1.0, gap / max(0.5 * float(steps.sum()), TINY))
    turns = np.full(len(search.points), np.nan)
    turns[slice(*run)] = np.arange(len(poses)) / period
    return Evidence(
        cloud.runs, turns, period, cloud.barcode, coordinate, 1.0, 1.0, cloud=cloud, closed=True
    )


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
            if often and along.steadiness >= VERDICT.steady:
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
        period = return_period(spread, cloud.runs)
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


def disagreement(points: Array, evidence: Evidence) -> float:
    """Return how far poses are from those a turn later, over how far any two are apart.

    Parameters
    ----------
    points : (F, d) ndarray
        One pose a frame.
    evidence : Evidence

    Returns
    -------
    float
        Of mean distances: 0 where a motion repeats exactly, about 1 where nothing does; NaN if
        nothing is seen twice.
    """
    turns = _one_after_the_other([evidence.turns[run] for run in evidence.runs.slices()])
    shown = points[evidence.runs.frames]
    later, missing = np.zeros(len(turns), np.intp), np.arange(len(turns))
    # The next time a phase is passed may be in a later run, more than one turn on.
    for whole in range(1, 2 + len(evidence.runs)):
        aim = turns[missing] + whole
        place = np.minimum(np.searchsorted(turns, aim), len(turns) - 1)
        there = np.abs(turns[place] - aim) < EVIDENCE.same_phase
        later[missing[there]] = place[there]
        missing = missing[~there]
    first = np.flatnonzero(later)
    if len(first) == 0:
        return float("nan")
    apart = np.linalg.norm(shown[later[first]] - shown[first], axis=1)
    some = shown[np.linspace(0, len(shown) - 1, EVIDENCE.sample).astype(np.intp)]
    any_two = np.linalg.norm(some[:, None] - some, axis=2)[np.triu_indices(len(some), 1)]
    return float(np.mean(apart) / np.mean(any_two))


def _one_after_the_other(parts: Sequence[Array]) -> Array:
    """Join the turns of runs, each begun whole turns later than the one before ended."""
    joined, end = [], -np.inf
    for part in parts:
        rising = np.maximum.accumulate(part)
        rising = rising + np.ceil(max(end - rising[0], 0.0))
        joined.append(rising)
        end = rising[-1]
    return np.concatenate(joined)


def _interpolated(frames: Indices, known: Indices, values: Array) -> Array:
    """Interpolate linearly, and go on with the end slopes beyond the known frames."""
    if len(known) < 2:
        return np.full(len(frames), float(values[0]))
    first = (values[1] - values[0]) / (known[1] - known[0])
    last = (values[-1] - values[-2]) / (known[-1] - known[-2])
    before, beyond = np.minimum(frames - known[0], 0), np.maximum(frames - known[-1], 0)
    return np.interp(frames, known, values) + first * before + last * beyond


def without_pauses(evidence: Evidence) -> Spans:
    """Cut the runs where the motion pauses, and drop what is left without a turn.

    A pause is a passage through a cell of the circle that takes twice as long as usual
    there and a good part of a period: a person stands, or turns around, before going on.

    Returns
    -------
    Spans
    """
    pauses = _pauses(evidence, 0.0) + _pauses(evidence, 0.5 / EVIDENCE.cells)
    kept: list[Span] = []
    for start, stop in evidence.runs:
        here = start
        for first, last in sorted(pauses):
            if start <= first and last <= stop:
                kept.append((here, max(here, first)))
                here = max(here, last)
        kept.append((here, stop))
    kept = [run for run in kept if _turned(evidence.turns, run) >= EVIDENCE.whole]
    passed = {
        cell % EVIDENCE.cells for run in kept for cell, _, _ in _passages(evidence.turns, run)[1:-1]
    }
    # What pauses at the only passage of a cell is no pause.
    return Spans(kept) if len(passed) == EVIDENCE.cells else evidence.runs


def _pauses(evidence: Evidence, offset: float) -> list[Span]:
    """List the frames of pauses, by cells whose borders are moved by `offset` turns.

    The usual time is that of whole passages; at the ends of a run, where a motion may begin
    from standing, no more than it is left.
    """
    turns = evidence.turns + offset
    passages = [_passages(turns, run) for run in evidence.runs]
    dwell: dict[int, list[int]] = {}
    for cell, first, last in (p for run in passages for p in run[1:-1]):
        dwell.setdefault(cell % EVIDENCE.cells, []).append(last - first)
    usual = {cell: sorted(times)[(len(times) - 1) // 2] for cell, times in dwell.items()}
    long = EVIDENCE.pause * evidence.period
    found = []
    for run in passages:
        for number, (cell, first, last) in enumerate(run):
            normal = usual.get(cell % EVIDENCE.cells, last - first)
            excess = last - first - normal
            if number == 0 and excess > long:
                found.append((first, last - normal))
            elif number == len(run) - 1 and excess > long:
                found.append((first + normal, last))
            elif excess > EVIDENCE.slower * normal and last - first > long:
                found.append((first + normal // 2, last - normal // 2))
    return found


def _turned(turns: Array, run: Span) -> float:
    return float(turns[run[1] - 1] - turns[run[0]]) if run[1] - run[0] > 1 else 0.0


def _passages(turns: Array, run: Span) -> list[tuple[int, int, int]]:
    """List the cells a run passes, with the frames of entry and exit."""
    cells = np.floor(np.maximum.accumulate(turns[run[0] : run[1]]) * EVIDENCE.cells).astype(int)
    entries = np.flatnonzero(np.diff(cells, prepend=cells[0] - 1))
    exits = np.append(entries[1:], len(cells))
    return [
        (int(cells[a]), run[0] + int(a), run[0] + int(b))
        for a, b in zip(entries, exits, strict=True)
    ]
