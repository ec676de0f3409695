"""Every constant that decides a result stands in a record, with unit, origin and margin."""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest

from roundelay import synth
from roundelay.base.thresholds import constants, overridden
from roundelay.timeline.limbs import body_of
from roundelay.timeline.proposals.recurrence import Recurrence

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src" / "roundelay"
RESULTS = ROOT / "benchmarks" / "results" / "sensitivity.json"

# Whole rooms, with whatever is put into them, and of the other rooms the modules that decide.
DECIDING = (
    "pipeline.py",
    "timeline",
    "phase",
    "segmentation",
    "cycles",
    "loops",
    "solving",
    "gait",
    "compare",
    "motion/poses.py",
    "motion/features.py",
    "geometry/kinematics.py",
    "geometry/contacts.py",
    "geometry/collision.py",
    "geometry/separation.py",
    "topology/coordinate.py",
    "topology/landmarks.py",
    "topology/lattice.py",
    "topology/lift.py",
    "topology/significance.py",
    "topology/toroidal.py",
    "library/groups.py",
)
PLAIN = (0.0, 0.5, 1.0, 2.0)
# Whole numbers that decide nothing: sizes of blocks in memory, reach of a formula, what is told,
# versions of files.
HARMLESS = {"BLOCK", "VERSION", "_BLOCK", "_MARKERS", "_PAIRS", "_REACH", "_ROWS"}


def deciding_modules() -> list[Path]:
    found: set[Path] = set()
    for place in (PACKAGE / name for name in DECIDING):
        found |= {place} if place.suffix else set(place.rglob("*.py"))
    return sorted(file for file in found if file.name != "thresholds.py")


def loose(source: str) -> Iterator[tuple[int, object]]:
    """Find the line and value of every constant that should stand in a record.

    These are all floating-point literals but 0, .5, 1 and 2, and whole numbers that a module
    names. Options are exempt: a field of a class `...Options`, and what is given to `option`, is
    shown to users with text and unit and is theirs to change. Numbers of arithmetic that decide
    nothing, such as what keeps a divisor from 0, have names in `roundelay.base.numeric`; factors
    of formulas are written as whole numbers.
    """
    tree = ast.parse(source)
    exempt = {id(inside) for node in ast.walk(tree) for inside in _options(node)}
    for node in ast.walk(tree):
        constant = isinstance(node, ast.Constant) and isinstance(node.value, float)
        if constant and id(node) not in exempt and node.value not in PLAIN:
            yield node.lineno, node.value
    for node in tree.body:
        names = [name.id for name in ast.walk(node) if isinstance(name, ast.Name)]
        if isinstance(node, ast.Assign) and not HARMLESS.issuperset(names):
            values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
            for value in values:
                if isinstance(value, ast.Constant) and type(value.value) is int:
                    yield value.lineno, value.value


def _options(node: ast.AST) -> Iterator[ast.AST]:
    if isinstance(node, ast.ClassDef) and node.name.endswith("Options"):
        for field in node.body:
            if isinstance(field, ast.AnnAssign):
                yield from ast.walk(field)
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "option":
        yield from ast.walk(node)


def test_deciding_modules_hold_no_loose_constant():
    files = deciding_modules()
    assert len(files) > 60
    found = [
        f"{file.relative_to(ROOT)}:{line}: {value} stands outside of a record of thresholds"
        for file in files
        for line, value in loose(file.read_text())
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("inserted", "value"),
    [
        ("_NEAR = 0.37", 0.37),
        ("def near(x, y=.37): return x < y", 0.37),
        ("near = x < 1.02 * 2.0", 1.02),
        ("def far(x): return x < -37.0", 37.0),
        ("_CELLS = 8", 8),
        ("_FRAMES, _LEAST = 1000, 0.5", 1000),
    ],
)
def test_an_inserted_constant_is_reported(inserted, value):
    source = (PACKAGE / "timeline" / "account.py").read_text()
    lines = source.count("\n") + 1
    assert list(loose(source)) == []
    assert list(loose(source + inserted + "\n")) == [(lines, value)]


@pytest.mark.parametrize(
    "allowed",
    [
        "x = 0.5 * y - 1.0",
        "def f(x): return 3 * x",
        "class SomeOptions:\n    energy: float = 0.9",
        'class Choice:\n    energy: float = option(0.9, "What is kept.", above=0.1)',
        "_BLOCK = 256",
    ],
)
def test_what_decides_nothing_is_allowed(allowed):
    assert list(loose(allowed)) == []


def test_every_constant_tells_its_unit_and_origin():
    known = constants()
    assert len({one.name for one in known}) == len(known) > 150
    assert [one.name for one in known if not (one.unit and one.origin)] == []


def test_every_constant_has_a_measured_margin():
    """After a constant is added or changed: python -m benchmarks.sensitivity --only NAME --keep."""
    kept = json.loads(RESULTS.read_text())
    measured = {row["name"]: row["value"] for row in kept["constants"]}
    now = {
        one.name: list(one.value) if isinstance(one.value, tuple) else one.value
        for one in constants()
    }
    assert measured == now
    assert kept["summary"]["constants"] == len(now)


def test_a_record_cannot_be_changed_but_for_a_while():
    one = next(one for one in constants() if one.name == "timeline.predictability.explained")
    with pytest.raises(FrozenInstanceError):
        one.record.explained = 0.3
    body = body_of(synth.gait("walk").motion)
    assert Recurrence().propose(body)
    with overridden(one, 2.0):
        assert Recurrence().propose(body) == []
    with suppress(KeyError), overridden(one, 0.0):
        raise KeyError
    assert one.record.explained == one.value
