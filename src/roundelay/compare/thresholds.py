"""Thresholds of comparing cycles."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["GROUPS", "NEAR", "SPECTRA", "WAVEFORMS"]


@dataclass(frozen=True)
class _Spectra(Thresholds):
    """What is kept of a cycle to compare it."""

    harmonics: int = constant(
        8,
        unit="harmonics",
        origin="what is left out has an RMS of some .0005 body sizes in captured cycles, and "
        "enters squared",
    )
    phases: int = constant(128, unit="phases", origin="a cycle is taken at for its harmonics")
    offsets: int = constant(
        32,
        unit="offsets",
        origin="tried before a parabola finds the best: four for a wave of the last harmonic",
    )


SPECTRA = _Spectra()


@dataclass(frozen=True)
class _Near(Thresholds):
    """The search for near signatures."""

    candidates: int = constant(
        384,
        unit="cycles",
        origin="looked at by vectors; those that may be among the nearest are compared exactly",
    )
    times: int = constant(4, unit="times", origin="as many candidates as are asked for, where more")
    slack: float = constant(
        1.02, unit="times", origin="squares of distances of vectors, which a graph keeps in 16 bits"
    )
    many: int = constant(20_000, unit="cycles", origin="from which on a graph is made")
    links: int = constant(16, unit="links", origin="of each vector in the graph")
    added: int = constant(96, unit="vectors", origin="looked at when one is added")
    searched: int = constant(128, unit="vectors", origin="looked at in a search")


NEAR = _Near()


@dataclass(frozen=True)
class _Groups(Thresholds):
    """Alike cycles of a library."""

    alike: float = constant(
        0.07,
        unit="lengths of leg and trunk",
        origin="of 850 behaviours of nine sources, .3 % of pairs of different names then share a "
        "group, and 22 % of those of one name; at .08 it is .4 and 24 %, at .05 0 and 10 %",
        margin="from .05 to .08",
    )
    neighbours: int = constant(16, unit="behaviours", origin="that each is linked to at most")
    prominence: float = constant(
        0.5,
        unit="near neighbours",
        origin="a hill lower than that above the way to a higher one is part of it; at 2, .3 % of "
        "pairs of different names share a group as well, but fewer groups stay when clips come",
    )
    near: float = constant(
        0.15,
        unit="lengths of leg and trunk",
        origin="a group may be called as the nearest named one up to here: that has the right name "
        "for 87 % of 216 behaviours of 14 names, half of them named",
    )
    nearer: float = constant(
        1.2,
        unit="times",
        origin="as many times as far as the nearest without a name; 92 % of the names are right "
        "then, 85 % where half of the names are not known; at 1, 95 and 94 % of fewer",
    )


GROUPS = _Groups()


@dataclass(frozen=True)
class _Waveforms(Thresholds):
    """Turns of joints that mean the same in two skeletons."""

    chunk: int = constant(256, unit="permutations", origin="at a time; for memory")
    bone: float = constant(
        0.02, unit="body sizes", origin="a shorter bone's direction tells nothing; " + BY_EYE
    )
    alike: float = constant(
        0.8,
        unit="cosine",
        origin="between bones in the axes of their joints where these are the same; " + BY_EYE,
    )
    turned: float = constant(
        60.0,
        unit="degrees",
        origin="between mean poses, median over joints: axes differ beyond it; " + BY_EYE,
    )


WAVEFORMS = _Waveforms()
