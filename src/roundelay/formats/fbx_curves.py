"""The curves of an FBX animation: keys, and what lies between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.clock import Clock
from roundelay.formats.fbx_elements import Element

__all__ = ["Curve", "read_curve", "read_old_curve"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Places = NDArray[np.intp]

# Bits of a key's flags: how the curve goes on to the next key, and how its slope is found.
_CONSTANT, _CUBIC = 0x2, 0x8
_NEXT, _AUTO, _TCB, _USER = 0x100, 0x100, 0x200, 0x400
_EVEN_HANDED, _CLAMP = 0x2000, 0x4000
# Per cent: how far a slope that is found leans to that of one side.
_WHOLLY = 100.0
_WEIGHTED_RIGHT, _WEIGHTED_LEFT = 0x1000000, 0x2000000
# Of the way to the next key, where a curve has no weights of its own; the unit of those.
_WEIGHT, _WEIGHT_UNIT = 1.0 / 3.0, 1e-4
# Halvings that find where a weighted curve is at a time.
_HALVINGS = 40


@dataclass(frozen=True)
class Curve:
    """A number over time.

    Parameters
    ----------
    times, values : (n,) ndarray
        Of the keys: seconds, rising.
    held, held_next : (n,) ndarray of bool
        Whether the curve keeps the key's value up to the next key, or has that one's at once.
    cubic : (n,) ndarray of bool
        Whether it is a curve up to the next key; else it is straight.
    slopes : (n, 2) ndarray
        Value a second at the key, and at the next one as it arrives there.
    weights : (n, 2) ndarray
        Parts of the time between for which these slopes count.
    """

    times: Array
    values: Array
    held: Flags
    held_next: Flags
    cubic: Flags
    slopes: Array
    weights: Array

    @property
    def straight(self) -> bool:
        """Whether it is a polygon."""
        return not (self.held.any() or self.held_next.any() or self.cubic.any())

    def at(self, clock: Clock) -> Array:
        """Return the values (F,) at the times of a clock."""
        before, after, gap, part = clock.between(self.times)
        first, second = self.values[before], self.values[after]
        result = first + part * (second - first)
        curved = self.cubic[before] & (after > before)
        result[curved] = self._curved(before[curved], after[curved], part[curved], gap[curved])
        result = np.where(self.held[before], first, result)
        return np.where(self.held_next[before] & (part > 0.0), second, result)

    def _curved(self, before: Places, after: Places, part: Array, gap: Array) -> Array:
        """Return Bezier curves, whose weights bend time as well."""
        right, left = self.weights[before].T
        t = _place(part, right, left)
        first, second = self.values[before], self.values[after]
        leaving = first + self.slopes[before, 0] * right * gap
        arriving = second - self.slopes[before, 1] * left * gap
        s = 1.0 - t
        return s**3 * first + 3 * s**2 * t * leaving + 3 * s * t**2 * arriving + t**3 * second


def _place(part: Array, right: Array, left: Array) -> Array:
    """Return where on a Bezier curve a part of the time is over."""
    if np.allclose(right, _WEIGHT, atol=_WEIGHT_UNIT) and np.allclose(
        left, _WEIGHT, atol=_WEIGHT_UNIT
    ):
        return part
    low, high = np.zeros_like(part), np.ones_like(part)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        rest = 1.0 - middle
        time = 3 * rest**2 * middle * right + 3 * rest * middle**2 * (1.0 - left) + middle**3
        low, high = np.where(time < part, middle, low), np.where(time < part, high, middle)
    return 0.5 * (low + high)


def read_curve(element: Element, ticks: float) -> Curve | None:
    """Read a curve of a file of version 7; None where it has no key.

    Parameters
    ----------
    element : Element
    ticks : float
        Of a second.

    Raises
    ------
    FormatError
        If its keys do not rise, or have no value each.
    """
    times, values = element.first("KeyTime"), element.first("KeyValueFloat")
    if times is None or values is None:
        return None
    seconds, shown = times.array().astype(float) / ticks, values.numbers()
    if len(seconds) != len(shown):
        raise values.error(f"{len(seconds)} values for as many keys", f"{len(shown)}")
    if not len(shown):
        return None
    flags, data = _attributes(element, len(shown))
    return _curve(times, seconds, shown, flags, data)


def _attributes(element: Element, count: int) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Return the flags (n,) and the data (n, 4) of keys: each row stands for several keys."""
    parts = [element.first(f"KeyAttr{name}") for name in ("Flags", "DataFloat", "RefCount")]
    if any(part is None for part in parts):
        return np.zeros(count, np.int64), np.zeros((count, 4), np.float32)
    flags, data, counts = (part.array() for part in parts if part is not None)
    data = data.view(np.float32) if data.dtype == np.int32 else data.astype(np.float32)
    whole = len(flags) == len(counts) and len(data) == 4 * len(counts)
    if not whole or np.any(counts < 0) or np.any(counts > count) or counts.sum() != count:
        raise element.error(f"flags of {count} keys", "others")
    repeats = counts.astype(np.intp)
    return np.repeat(flags.astype(np.int64), repeats), np.repeat(data.reshape(-1, 4), repeats, 0)


def _curve(
    element: Element,
    seconds: Array,
    values: Array,
    flags: NDArray[np.int64],
    data: NDArray[np.float32],
) -> Curve:
    if not np.all(np.diff(seconds) >= 0.0):
        raise element.error("keys at times that rise", "others")
    # Of keys at one time the last counts.
    kept = np.append(np.diff(seconds) > 0.0, True)
    seconds, values, flags, data = seconds[kept], values[kept], flags[kept], data[kept]
    cubic = (flags & _CUBIC) != 0
    constant = ((flags & _CONSTANT) != 0) & ~cubic
    following = constant & ((flags & _NEXT) != 0)
    with np.errstate(all="ignore"):
        slopes = np.nan_to_num(data[:, :2].astype(float), posinf=0.0, neginf=0.0)
    weights = _weights(flags, np.ascontiguousarray(data[:, 2]))
    _fill_slopes(slopes, flags, weights, seconds, values)
    _fill_tcb(slopes, cubic & ((flags & _TCB) != 0), data, seconds, values)
    return Curve(seconds, values, constant & ~following, following, cubic, slopes, weights)


def _weights(flags: NDArray[np.int64], packed: NDArray[np.float32]) -> Array:
    """Return the weights of keys: two numbers of 16 bits in the place of a float."""
    bits = packed.view(np.uint32)
    told = np.stack([bits & 0xFFFF, bits >> 16], axis=1) * _WEIGHT_UNIT
    known = np.stack([flags & _WEIGHTED_RIGHT, flags & _WEIGHTED_LEFT], axis=1) != 0
    return np.where(known, np.clip(told, 0.0, 1.0), _WEIGHT)


def _fill_slopes(
    slopes: Array, flags: NDArray[np.int64], weights: Array, seconds: Array, values: Array
) -> None:
    """Set the slopes at keys that have them found: along the neighbours, or leaning to one side.

    At the ends they go to the neighbour, or are flat where slopes are kept from overshooting.
    """
    chosen = ((flags & _CUBIC) != 0) & ((flags & (_USER | _TCB)) == 0)
    if not chosen.any() or len(values) < 2:
        return
    even, clamped = (flags & _EVEN_HANDED) != 0, (flags & _CLAMP) != 0
    gaps = np.diff(seconds)
    chords = np.diff(values) / gaps
    left, right = np.append(chords[:1], chords), np.append(chords, chords[-1])
    before, after = np.append(gaps[:1], gaps), np.append(gaps, gaps[-1])
    mean = (left * before + right * after) / (before + after)
    limit = _limits(left, right, mean, np.append(_WEIGHT, weights[:-1, 1]), weights[:, 0])
    # Leanings stand where slopes would: to the right that at the key, to the left that of the next.
    told = np.where(even[:, None], 0.0, slopes)
    found = []
    for leaning in (told[:, 0], np.append(0.0, -told[:-1, 1])):
        part = np.clip(np.abs(leaning) / _WHOLLY, 0.0, 1.0)
        slope = mean + part * (np.where(leaning > 0.0, right, left) - mean)
        found.append(np.where(clamped, np.sign(slope) * np.minimum(np.abs(slope), limit), slope))
    slopes[chosen, 0] = found[0][chosen]
    arriving = np.flatnonzero(chosen[1:])
    slopes[arriving, 1] = found[1][arriving + 1]


def _limits(left: Array, right: Array, mean: Array, before: Array, after: Array) -> Array:
    """Return the largest slopes that do not overshoot the neighbours; none at the ends."""
    sign = np.where(mean >= 0.0, 1.0, -1.0)
    with np.errstate(all="ignore"):
        most = np.fmin(np.maximum(sign * left, 0.0) / before, np.maximum(sign * right, 0.0) / after)
    most[[0, -1]] = 0.0
    return np.asarray(np.nan_to_num(most))


def _fill_tcb(
    slopes: Array, chosen: Flags, data: NDArray[np.float32], seconds: Array, values: Array
) -> None:
    """Set the slopes at keys that have tension, continuity and bias (Kochanek and Bartels)."""
    for key in np.flatnonzero(chosen).tolist():
        t, c, b = np.nan_to_num(data[key, :3].astype(float))
        before, after = max(key - 1, 0), min(key + 1, len(values) - 1)
        left = _ratio(values[key] - values[before], seconds[key] - seconds[before])
        right = _ratio(values[after] - values[key], seconds[after] - seconds[key])
        share = (0.5 if before < key < after else 1.0) * (1 - t)
        slopes[key, 0] = share * ((1 - c) * (1 - b) * right + (1 + c) * (1 + b) * left)
        if key:
            slopes[before, 1] = share * ((1 + c) * (1 - b) * right + (1 - c) * (1 + b) * left)


def _ratio(rise: float, time: float) -> float:
    return rise / time if time > 0.0 else 0.0


def read_old_curve(channel: Element, ticks: float) -> Curve | None:
    """Read a channel of a take of a file before version 7; None where it has no key.

    Parameters
    ----------
    channel : Element
    ticks : float
        Of a second.

    Raises
    ------
    FormatError
        If its keys are not such as are known, or do not rise.
    """
    key = channel.first("Key")
    if key is None or not key.values:
        return None
    rows = list(_old_keys(key))
    seconds = np.array([row[0] for row in rows]) / ticks
    values = np.array([row[1] for row in rows])
    flags = np.array([row[2] for row in rows], np.int64)
    data = np.zeros((len(rows), 4), np.float32)
    data[:, :3] = np.clip([row[3] for row in rows], -1e30, 1e30)
    weights = np.array([row[4] for row in rows])
    curve = _curve(key, seconds, values, flags, data)
    return _weighted(curve, weights[np.append(np.diff(seconds) > 0.0, True)])


def _weighted(curve: Curve, weights: Array) -> Curve:
    known = np.where(np.isfinite(weights), np.clip(weights, 0.0, 1.0), _WEIGHT)
    return replace(curve, weights=known)


_OldKey = tuple[float, float, int, tuple[float, float, float], tuple[float, float]]


def _old_keys(key: Element) -> Iterator[_OldKey]:
    """Yield time, value, flags, slopes and weights of keys; a letter says what follows."""
    words = iter(key.values)
    for time in words:
        value, mode = next(words, None), next(words, None)
        if not (_is_number(time) and _is_number(value) and isinstance(mode, str)):
            raise key.error("a time, a value and a letter for each key", "others")
        flags, slopes, weights = 0x4, (0.0, 0.0, 0.0), (np.nan, np.nan)
        if mode == "C":
            flags = _CONSTANT | (_NEXT if next(words, "s") == "n" else 0)
        elif mode == "U":
            flags, slopes, count = _old_slopes(key, words)
            for _ in range(count):
                weights = _old_weights(key, words)
        elif mode != "L":
            raise key.error("keys of the kinds C, L and U", repr(mode))
        yield float(time), float(value), flags, slopes, weights


def _old_slopes(key: Element, words: Iterator[Any]) -> tuple[int, tuple[float, float, float], int]:
    """Return flags, slopes (or tension, continuity, bias), and how many weights follow."""
    kind = next(words, None)
    if kind in ("s", "b"):
        return _CUBIC | _USER, (_number(key, words), _number(key, words), 0.0), 1
    if kind == "a":
        return _CUBIC | _AUTO, (0.0, 0.0, 0.0), 1
    if kind == "p":
        _number(key, words)
        return _CUBIC | _AUTO, (0.0, 0.0, 0.0), 2
    if kind == "t":
        tcb = _number(key, words), _number(key, words), _number(key, words)
        return _CUBIC | _TCB, tcb, 1
    raise key.error("slopes of the kinds s, b, a, p and t", repr(kind))


def _old_weights(key: Element, words: Iterator[Any]) -> tuple[float, float]:
    kind = next(words, "n")
    right = _number(key, words) if kind in ("r", "a", "b") else np.nan
    left = _number(key, words) if kind in ("l", "a", "b") else np.nan
    return right, left


def _number(key: Element, words: Iterator[Any]) -> float:
    value = next(words, None)
    if not _is_number(value):
        raise key.error("a number", repr(value))
    return float(value)


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, int | float) and abs(value) < 1e18
