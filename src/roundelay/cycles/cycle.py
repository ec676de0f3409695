"""A cycle: one period of a motion as a closed, smooth curve of poses, with its travel."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.threads import one_thread
from roundelay.cycles.above import Above
from roundelay.cycles.edit.footlock import lock_feet
from roundelay.cycles.thresholds import CYCLE
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion, checked_rate
from roundelay.phase.harmonic import HarmonicCurve
from roundelay.timeline.evidence import Evidence

__all__ = ["Cycle"]

Array = NDArray[np.float64]
Change = tuple[Array, Array, Array | None]


@dataclass(frozen=True, eq=False)
class Cycle:
    """Hold a periodic motion that can be evaluated at any phase.

    The root moves as it did in the capture, gait for gait: its path is the integral of a
    periodic velocity in a frame that turns steadily ([C] 3.9 has a line instead). Where a joint
    below the root carried the body, the curves hold its motion as the root's, as
    `Motion.with_root_motion` does; `sample` and `at` give it back.

    Parameters
    ----------
    skeleton : Skeleton
    period : float
        Seconds.
    pose : HarmonicCurve
        Quaternions of all joints, 4 J values, before normalisation; the root's without its
        steady turning. Zero for the joints of `odd_pose`.
    odd_pose : HarmonicCurve or None
        The same for joints that make an odd number of whole turns in a period.
    velocity : HarmonicCurve
        Velocity of the root in the turning frame, lengths a period; 3 values, the vertical
        one zero unless the motion climbs.
    height : HarmonicCurve
        Height of the root above the path's plane, 1 value; its mean only where it climbs.
    turning : float
        Radians the heading gains in a period.
    up : int
        The axis that points up.
    fps : float
        Frame rate of the capture, the default for `sample`.
    translations : HarmonicCurve or None
        Local positions of joints, 3 J values, where bones change length.
    name : str
        A name for people.
    evidence : Evidence or None
        What the cycle was found by: the frames that show it, its barcode and coordinate.
    above : Above or None
        What the joints above the one that carried the body did; None where the root did.
    phase : (F,) ndarray or None
        The phase of the capture's frames that it was fitted by: unwrapped, in turns, and NaN
        outside the parts that show the motion.
    method : str
        The cycle model that made it, by name; empty for a blend.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> cycle = rl.find_cycles(walk)[0]
    >>> loop = cycle.sample(fps=30.0)
    >>> len(loop), round(cycle.period, 2)
    (33, 1.1)
    """

    skeleton: Skeleton
    period: float
    pose: HarmonicCurve
    odd_pose: HarmonicCurve | None
    velocity: HarmonicCurve
    height: HarmonicCurve
    turning: float
    up: int
    fps: float
    translations: HarmonicCurve | None = None
    name: str = ""
    evidence: Evidence | None = field(default=None, repr=False)
    above: Above | None = None
    phase: Array | None = field(default=None, repr=False)
    method: str = ""

    def __repr__(self) -> str:
        joints = self.skeleton.n_joints
        return f"Cycle({self.name!r}, period {self.period:.3f} s, {joints} joints)"

    @property
    def travel(self) -> Array:
        """Displacement (3,) of the root over one period, in the skeleton's length unit."""
        return self.root_path(np.array([0.0, 1.0]))[1] - self.root_path(np.zeros(1))[0]

    @property
    def speed(self) -> float:
        """Mean speed along the ground, in the skeleton's length unit a second."""
        return float(np.linalg.norm(np.delete(self.velocity.constant, self.up))) / self.period

    @property
    def travels(self) -> bool:
        """Whether it goes anywhere, rather than stays where it is but for some drift."""
        return bool(self.speed * self.period >= CYCLE.travels * self.skeleton.size)

    def save(self, path: str | Path) -> None:
        """Write the cycle to an NPZ; see `roundelay.cycles.saved.save_cycle`."""
        from roundelay.cycles.saved import save_cycle

        save_cycle(self, path)

    @staticmethod
    def load(path: str | Path) -> Cycle:
        """Read a cycle that was saved; see `roundelay.cycles.saved.load_cycle`.

        What it was found by is not there: it has no repetitions.
        """
        from roundelay.cycles.saved import load_cycle

        return load_cycle(path)

    def rotations(self, phase: ArrayLike) -> Array:
        """Return local rotations (n, J, 4) at phases (n,), the root's without its turning."""
        x = np.asarray(phase, float)
        values = self.pose(x)
        if self.odd_pose is not None:
            values = values + self.odd_pose(x)
        return rot.normalize(values.reshape(len(x), self.skeleton.n_joints, 4))

    def heading(self, phase: ArrayLike) -> Array:
        """Return the steady turning (n,) in radians reached at unwrapped phases (n,)."""
        return self.turning * np.asarray(phase, float)

    def root_path(self, phase: ArrayLike, *, in_place: bool = False) -> Array:
        """Return the root's position (n, 3) at unwrapped phases (n,), at 0 above the origin.

        Parameters
        ----------
        phase : (n,) array_like
        in_place : bool
            Leave out the mean velocity and the turning; the path is then closed and centred.
        """
        x = np.asarray(phase, float)
        if in_place:
            still = replace(self.velocity, constant=np.zeros(3))
            path = still.integral(x) + still.sine.T @ (-1 / (2 * np.pi * still.frequencies))
        else:
            path = self._turned_integral(x)
        path[:, self.up] += self.height(x)[:, 0]
        return path

    def _turned_integral(self, x: Array) -> Array:
        """Integrate the velocity, turned by the heading, from phase 0.

        In the plane, as complex numbers, the velocity is sum c_k exp(2 pi i k x) and the
        heading exp(i turning x), so that every term integrates by itself.
        """
        path = self.velocity.integral(x)
        amplitudes, rates = self._terms()
        self._set_plane(path, _integrals(x, rates) @ amplitudes)
        return path

    def steady_path(self, phase: ArrayLike) -> Array:
        """Return the path (n, 3) at the mean velocity, amid the root's sway about it.

        Its height is 0 unless the motion climbs. Seen in the heading, the root's path lies
        about it by a periodic curve whose mean in the plane is 0.
        """
        x = np.asarray(phase, float)
        amplitudes, rates = self._terms()
        turns = 2 * np.pi * self.velocity.frequencies[:, None]
        path = x[:, None] * self.velocity.constant + np.sum(self.velocity.sine / turns, axis=0)
        # Of exp(i r x) - 1 the second term is no sway but where it begins.
        middle = 1j * np.sum(amplitudes[1:] / rates[1:])
        self._set_plane(path, _integrals(x, rates[:1]) @ amplitudes[:1] + middle)
        return path

    def _terms(self) -> tuple[NDArray[np.complex128], Array]:
        """Return amplitudes and rates (radians a period) of the turned velocity, mean first."""
        v, frequencies = self.velocity, 2 * np.pi * self.velocity.frequencies
        cosine, sine, mean = map(self._as_complex, (v.cosine, v.sine, v.constant))
        c = np.concatenate([[mean], (cosine - 1j * sine) / 2, (cosine + 1j * sine) / 2])
        return c, self.turning + np.concatenate([[0.0], frequencies, -frequencies])

    def _as_complex(self, vectors: Array) -> NDArray[np.complex128]:
        across, along = (self.up + 1) % 3, (self.up + 2) % 3
        return np.asarray(vectors[..., across] + 1j * vectors[..., along])

    def _set_plane(self, path: Array, plane: NDArray[np.complex128]) -> None:
        path[:, (self.up + 1) % 3], path[:, (self.up + 2) % 3] = plane.real, plane.imag

    @one_thread
    def sample(
        self,
        fps: float | None = None,
        *,
        periods: int = 1,
        start: float = 0.0,
        in_place: bool = False,
        repeat_first: bool = False,
        heading: float | None = None,
        foot_lock: bool = True,
    ) -> Motion:
        """Return the cycle as frames that loop.

        A period is given the whole number of frames nearest to it, so that the frame after
        the last one is the first again.

        Parameters
        ----------
        fps : float, optional
            Frames a second; the capture's by default.
        periods : int
            How many periods, one after the other.
        start : float
            Phase of the first frame.
        in_place : bool
            Leave out the root's travel and turning.
        repeat_first : bool
            Append the frame that repeats the first, as some programs want.
        heading : float, optional
            Turn the motion about the vertical so that at phase 0 it travels in this direction,
            in radians from the Z axis towards X (from X towards Y where Z points up); as in
            the capture by default, and for motions that do not travel.
        foot_lock : bool
            Hold standing feet still; see `roundelay.cycles.edit.footlock`.

        Raises
        ------
        ValueError
            If `fps` or `periods` is not positive, or `fps` beyond 10,000.
        """
        rate = checked_rate(self.fps if fps is None else fps)
        if periods < 1:
            raise ValueError(f"expected at least one period, found {periods}")
        count = max(1, round(self.period * rate))
        frames = np.arange(count * periods + int(repeat_first))
        phase = start + frames / count
        motion = self._body(phase, 1.0 / rate, in_place)
        rotations = motion.rotations.copy()
        if foot_lock:
            # The periods before and after decide about feet that stand across the seam.
            around = self._body(start + np.arange(-count, 2 * count) / count, 1.0 / rate, False)
            legs, turns = lock_feet(around, count)
            rotations[:, legs] = turns[count : 2 * count][frames % count]
        motion = self._given_back(replace(motion, rotations=rotations), phase, in_place)
        if heading is None:
            return motion
        return motion.turned(self._about_up(self._turn_to(heading)))

    def _turn_to(self, direction: float) -> float:
        """Return the angle from where phase 0 travels to a direction; 0 without travel."""
        if not self.travels:
            return 0.0
        return direction - float(np.angle(self._as_complex(self.velocity.constant)))

    @one_thread
    def at(
        self,
        phase: ArrayLike,
        *,
        frame_time: float,
        in_place: bool = False,
        change: Change | None = None,
    ) -> Motion:
        """Return the poses at unwrapped phases (n,) as a motion; see `sample`.

        Parameters
        ----------
        phase : (n,) array_like
        frame_time : float
            Seconds from one to the next.
        in_place : bool
            Leave out the root's travel and turning.
        change : tuple, optional
            What is added: rotation vectors (n, J, 3) of the joints, the root's way (n, 3), and,
            where bones change length, places (n, J, 3) of joints on their parents.
        """
        x = np.asarray(phase, float)
        return self._given_back(self._body(x, frame_time, in_place, change), x, in_place)

    def _body(
        self, x: Array, frame_time: float, in_place: bool, change: Change | None = None
    ) -> Motion:
        """Return the poses at phases with the body's motion in the root."""
        rotations, path = self.rotations(x), self.root_path(x, in_place=in_place)
        moved = None
        if self.translations is not None:
            moved = self.translations(x).reshape(len(x), self.skeleton.n_joints, 3)
        if change is not None:
            turns, way, places = change
            rotations = rot.multiply(rotations, rot.from_rotation_vector(turns))
            path = path + way
            moved = moved if moved is None or places is None else moved + places
        if not in_place:
            turn = self._about_up(self.heading(x))
            rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
        return Motion(
            skeleton=self.skeleton,
            rotations=rotations,
            root_path=path,
            frame_time=frame_time,
            translations=moved,
            name=self.name,
            up=self.up,
        )

    def _given_back(self, motion: Motion, x: Array, in_place: bool) -> Motion:
        """Give the joints above the one that carried the body their own motion again."""
        if self.above is None:
            return motion
        if in_place:
            return self.above.given(motion, rot.identity(len(x)), np.zeros((len(x), 3)))
        return self.above.given(motion, self._about_up(self.heading(x)), self.steady_path(x))

    def _about_up(self, angle: ArrayLike) -> Array:
        """Return the rotations (..., 4) by angles (...) about the up axis."""
        return rot.from_rotation_vector(np.asarray(angle)[..., None] * np.eye(3)[self.up])


def _integrals(x: Array, rates: Array) -> NDArray[np.complex128]:
    """Return the integrals of exp(i r x) from 0, (n, m), sound at r = 0 too."""
    # (exp(i r x) - 1) / (i r) = x exp(i r x / 2) sinc(r x / 2 pi).
    half = 0.5 * x[:, None] * rates
    return np.asarray(x[:, None] * np.exp(1j * half) * np.sinc(half / np.pi))
