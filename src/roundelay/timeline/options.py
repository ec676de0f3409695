"""What a user may choose of the search; all automatic unless given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from roundelay.base.options import Checked, option
from roundelay.base.spans import Span
from roundelay.motion.features import Features, Weights

__all__ = ["Options", "PoseMetric", "ShownOptions", "TopologyOptions"]

PoseMetric = Literal["euclidean", "variance", "adjacent"]
ROOT_MODELS = ("line", "periodic", "none")


_CLASSES: int | None = option(
    None,
    "So many classes: those of the longest bars of all frames become a motion each (loop), or "
    "are shown; by default five of each motion (inspect), those that stand out (excitations).",
    least=1,
)


@dataclass(frozen=True)
class TopologyOptions(Checked):
    """Choices of what topology sees and which of its classes counts.

    Parameters
    ----------
    prime : int
        Coefficients of the cohomology are integers modulo this prime.
    class_index : int, optional
        Which bar of the first motion, or of `Options.motion`, to use, 0 being the longest; by
        default the first that turns with the repetitions.
    max_scale : float, optional
        Largest scale of the filtration, in body sizes ([C] 5.3 item 5): classes born above are
        left out, and bars end there. By default that at which every class has died.
    scale : float, optional
        Scale of the coordinate, between birth and death of the bar, in body sizes.
    delay : float, optional
        Seconds by which velocity is weighed against position: period / 2 pi by default, 0 for
        poses alone.
    delays : int, optional
        Use a delay embedding of so many delays over half a period ([C] 3.8; [A] 4.2) instead
        of velocities. It loses half a period at the end of every part.
    metric : {"euclidean", "variance", "adjacent"}
        Distances of poses as they are, of features divided by their standard deviations
        ([A] 6.4), or with frames next to each other in time at distance 0 ([A] 3.2).
    classes : int, optional
        Follow so many of the longest bars of all frames, each as a motion of its own ([C] 5.3),
        instead of the timeline's behaviours.
    dimensions : int or float, optional
        Project on so many principal axes first, or on those that hold this share of the
        variance ([A] 5.1); none by default.

    Raises
    ------
    ValueError
        If a value is out of range.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> topology = rl.TopologyOptions(prime=3, class_index=0)
    >>> len(rl.find_cycles(walk, rl.Options(topology=topology)))
    1
    """

    title: ClassVar[str] = "What topology sees"

    prime: int = option(47, "Coefficients are integers modulo this prime.", least=2)
    class_index: int | None = option(
        None, "Use this bar, 0 being the longest; see inspect.", least=0, flag="class"
    )
    max_scale: float | None = option(
        None, "Largest scale of the filtration: bars end there.", unit="body sizes", above=0
    )
    scale: float | None = option(
        None, "Scale of the circular coordinate.", unit="body sizes", above=0
    )
    delay: float | None = option(
        None,
        "By how much velocity is weighed against position; 0 for poses alone.",
        unit="seconds",
        least=0,
    )
    delays: int | None = option(None, "Delays over half a period, instead of velocities.", least=1)
    metric: PoseMetric = option(
        "euclidean",
        "Distance of poses: as they are, of features divided by their standard deviations, or "
        "with frames next to each other at distance 0.",
    )
    classes: int | None = _CLASSES
    dimensions: int | float | None = option(
        None, "Principal axes to project on, or the share of variance (below 1) they hold.", above=0
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        axes = self.dimensions
        if isinstance(axes, float) and axes >= 1.0:
            raise ValueError(
                f"expected a whole number of dimensions or a share below 1, found {axes:g}"
            )


@dataclass(frozen=True)
class Options(Checked):
    """Choices of the main job.

    Parameters
    ----------
    frames : (int, int or None), optional
        Half-open range of frames to look at, None for the end of the take; by default all but
        neutral poses put before or behind them.
    joints : tuple of str, optional
        Joints that decide what is a repetition; all by default. Every joint is in the cycle.
    features : {"positions", "heading", "quaternions", "angles", "configuration"}
        What a pose is to the search, see `roundelay.point_cloud`; "configuration" is that of
        [A]: joint angles, and the root by its first differences.
    weights : {"none", "length", "mass"}
        Weigh every joint by the length of its bones ([C] ch. 4) or by that of all bones it
        moves, which stands for their mass ([A] 7). Positions weigh by length of themselves.
    topology : TopologyOptions
        Prime, class, scale, velocity or delays, metric, dimensions.
    proposers : tuple of str, optional
        Who proposes what may repeat, by name; all by default: "recurrence", "excitation", then
        those that plug-ins bring; see `roundelay.timeline.proposals`.
    motion : int, optional
        Only this motion, 1 being the first of those that `inspect` lists. A class or a scale of
        `topology` is that of this motion, or of the first.
    phrase : bool
        Where periods nest, take the long one: a phrase made of beats.
    uncertain : bool
        Also what rather does not repeat, with a probability below one half.
    most : int, optional
        Return this many cycles at most, best first.
    method : str
        How poses become a cycle, by the name of a cycle model: "harmonic" (regression of
        quaternions), "take" (the most typical repetition as it was played), "auto" (the first, or
        the second where a limb would lose a fifth of its movement), "centroid" ([A] 4.4), "paper"
        ([C]'s weighted regression of angles, eq. 3.14), or one that a plug-in brings.
    harmonics : int, optional
        Number of harmonics of the cycle; by default what the period can need, and [C]'s 20
        with the method "paper".
    velocity, acceleration : bool
        Constrain the method "paper" by the velocities and accelerations of the frames
        ([C] 5.3 items 20, 21): both are [C]'s model M1, neither is M2. Other methods have
        no such constraints.
    root : tuple of str, optional
        How the method "paper" models the root's path along each axis ([C] 3.9): "x=line",
        "y=periodic", "z=none" and so on; a line with harmonics (eq. 3.27), harmonics alone (eq.
        3.6), or no movement. By default a line along what is level, harmonics upwards.
    neighbours : int, optional
        Of how many poses the method "centroid" takes the mean, 10 by default ([A] 6.1).
    gaussian : bool
        Weigh them by a Gaussian of their distance in phase ([A] 4.4).

    Raises
    ------
    ValueError
        If a value is out of range.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> options = rl.Options(frames=(0, 90), most=1)
    >>> [round(cycle.period, 2) for cycle in rl.find_cycles(walk, options)]
    [1.1]
    """

    title: ClassVar[str] = "What is looked for"

    frames: tuple[int, int | None] | None = option(
        None,
        "Look at these frames only, from 0, the last left out.",
        unit="frames",
        least=0,
        form="START:STOP",
    )
    joints: tuple[str, ...] | None = option(
        None, "Look at these joints only.", form="JOINT,JOINT,..."
    )
    features: Features = option("positions", "What a pose is.")
    weights: Weights = option(
        "none", "Weigh joints by the length of their bones, or by that of all bones they move."
    )
    topology: TopologyOptions = option(TopologyOptions, "What topology sees.")
    proposers: tuple[str, ...] | None = option(
        None,
        "Who proposes what may repeat, of {proposers}; all by default.",
        form="NAME,NAME,...",
    )
    motion: int | None = option(
        None, "Only this motion, 1 being the first; --class and --scale are of it.", least=1
    )
    phrase: bool = option(False, "Where periods nest, take the long one.")
    uncertain: bool = option(False, "Also what rather does not repeat.")
    most: int | None = option(
        None, "At most so many periodic motions, the surest first.", least=1, label="Max Loops"
    )
    method: str = option(
        "auto",
        "auto: harmonic, or take where a limb would lose a fifth of its movement; harmonic: a "
        "smooth mean; take: the most typical repetition as it was played; centroid: means of "
        "poses, as in [A]; paper: the weighted regression of [C].",
    )
    harmonics: int | None = option(None, "Harmonics of the cycle.", least=1, most=500)
    velocity: bool = option(True, "Constrain the method paper by velocities, as [C].")
    acceleration: bool = option(True, "Constrain the method paper by accelerations, as [C].")
    root: tuple[str, ...] | None = option(
        None,
        "Model of the root's path by the method paper, an axis each: line, periodic or none.",
        form="x=line,y=periodic,z=none",
    )
    neighbours: int | None = option(
        None, "Poses of a mean of the method centroid; 10 by default, as in [A].", least=1
    )
    gaussian: bool = option(False, "Weigh the poses of the method centroid by a Gaussian.")

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("joints", "proposers"):
            if getattr(self, name) == ():
                raise ValueError(f"expected {name} as at least one name, or None, found none")
        if self.method != "paper" and not (self.velocity and self.acceleration):
            raise ValueError(
                "expected velocity and acceleration to be left out of the method 'paper' only, "
                f"found {self.method!r}"
            )
        if self.method != "centroid" and (self.neighbours is not None or self.gaussian):
            raise ValueError(
                "expected neighbours and gaussian with the method 'centroid' only, "
                f"found {self.method!r}"
            )
        if self.root is not None:
            self._check_root(self.root)

    def _check_root(self, given: tuple[str, ...]) -> None:
        if self.method != "paper":
            raise ValueError(f"expected root with the method 'paper' only, found {self.method!r}")
        axes = [word.partition("=")[0] for word in given]
        kinds = [word.partition("=")[2] for word in given]
        known = {"x", "y", "z"}.issuperset(axes) and set(ROOT_MODELS).issuperset(kinds)
        if not (given and known and len(set(axes)) == len(axes)):
            told = ",".join(given)
            raise ValueError(
                f"expected root as x, y or z = one of {ROOT_MODELS}, each axis once, such as "
                f"'x=line,y=periodic', found {told!r}"
            )

    @property
    def root_models(self) -> dict[int, str]:
        """The models of `root` by the number of their axis."""
        pairs = [word.partition("=") for word in self.root or ()]
        return {"xyz".index(axis): kind for axis, _, kind in pairs}

    def span(self, count: int) -> Span | None:
        """Return the frames to look at of a take of so many; None where all are.

        Raises
        ------
        ValueError
            If they are not all there.
        """
        if self.frames is None:
            return None
        start, stop = self.frames[0], count if self.frames[1] is None else self.frames[1]
        if not start < stop <= count:
            raise ValueError(f"expected frames within 0 and {count}, found {start} to {stop}")
        return start, stop


@dataclass(frozen=True)
class ShownOptions(Checked):
    """Choices of what is shown of the classes.

    Parameters
    ----------
    classes : int, optional
        How many.
    """

    title: ClassVar[str] = "What is shown"

    classes: int | None = _CLASSES
