"""Every public door: what makes no sense is refused in the project's own words."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import roundelay as rl
from roundelay import topology

# Made by roundelay, not by callers; or no function at all.
_NOT_MADE = {"Evidence", "Poses", "Metric", "Runs", "excitations"}
# How an error of ours begins, where it is one of Python's types.
_OURS = "expected"

NONSENSE: list[Any] = [
    None,
    3,
    -1,
    True,
    "text",
    b"bytes",
    float("nan"),
    float("inf"),
    np.float64(2.0),
    object(),
    {},
    [1, 2],
    [[1], [2, 3]],
    np.zeros(0),
    np.zeros((0, 3)),
    np.zeros((100, 5)),
    np.zeros(5, object),
    np.array(["a", "b"]),
    np.array(1j),
]


def doors() -> Iterator[tuple[str, Callable[..., Any], int]]:
    """The public functions and classes, and how many arguments each must be given."""
    for module in (rl, topology):
        for name in sorted(set(module.__all__) - _NOT_MADE):
            door = getattr(module, name)
            if not callable(door) or (
                isinstance(door, type) and issubclass(door, BaseException | rl.RoundelayWarning)
            ):
                continue
            parameters = inspect.signature(door).parameters.values()
            needed = [p for p in parameters if p.default is p.empty and p.kind in (0, 1)]
            if needed:
                yield f"{module.__name__}.{name}", door, len(needed)


def refusal(door: Callable[..., Any], arguments: list[Any]) -> Exception | None:
    """Return what a door raises, if that is no error of ours."""
    try:
        door(*arguments)
    except (rl.RoundelayError, OSError):
        return None
    except (TypeError, ValueError) as error:
        return None if _OURS in str(error) else error
    except Exception as error:
        return error
    return None


DOORS = list(doors())


@pytest.mark.parametrize(("name", "door", "count"), DOORS, ids=[name for name, *_ in DOORS])
def test_nonsense_is_refused_in_our_words(name, door, count, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        told = [(value, refusal(door, [value] * count)) for value in NONSENSE]
    assert [(name, *one) for one in told if one[1] is not None] == []


def test_paths_are_text_or_paths():
    for door in (rl.read, lambda path: rl.write(None, path), lambda p: rl.build_library(p, "l")):
        with pytest.raises(TypeError, match=r"^expected a path, found bytes$"):
            door(b"walk.bvh")


@pytest.mark.parametrize("prime", [47.0, "47", None, 1, 4, 46349, True])
def test_only_primes_are_primes(prime):
    with pytest.raises(ValueError, match=r"^expected a prime from 2 to 46337, found "):
        topology.persistent_cohomology(np.eye(5), prime=prime)


def test_a_coefficient_is_a_whole_number():
    barcode = topology.persistent_cohomology(np.random.default_rng(0).random((30, 2)))
    with pytest.raises(ValueError, match="as whole numbers"):
        topology.combined_coordinates(barcode, [[1.5, 0.0]])
