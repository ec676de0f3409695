"""What a user can name: each public name once, and the names that others rely on."""

from __future__ import annotations

import ast
import importlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import roundelay as rl
from roundelay import synth

ROOT = Path(rl.__file__).parent
PUBLIC_MODULES = tuple(
    f"roundelay.{name}" for name in ("segmentation", "synth", "testing", "topology")
)


def fresh(code: str) -> object:
    """What a program prints, as JSON, in a process of its own."""
    command = [sys.executable, "-c", "import json; import roundelay; " + code]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)


def test_the_public_names_are_those_of_dir():
    shown = "[name for name in dir(roundelay) if not name.startswith('_')]"
    assert fresh(f"print(json.dumps({shown}))") == rl.__all__ == sorted(set(rl.__all__))


def test_every_public_name_is_there_and_documented():
    for name in rl.__all__:
        assert getattr(rl, name).__doc__, name


@pytest.mark.parametrize("name", ["cli", "commands", "library", "pipeline", "no_such_name"])
def test_a_submodule_is_not_public_by_accident(name):
    code = f"print(json.dumps(hasattr(roundelay, '{name}')))"
    assert fresh(code) is False


def test_what_is_missing_is_named():
    with pytest.raises(AttributeError, match="module 'roundelay' has no attribute 'no_such_name'"):
        rl.no_such_name  # noqa: B018


@pytest.mark.parametrize("name", PUBLIC_MODULES)
def test_public_modules_are_reached_in_every_way(name):
    short = name.partition(".")[2]
    code = f"a = roundelay.{short}; from roundelay import {short} as b; import {name} as c; "
    assert fresh(code + "print(json.dumps(a is b is c))") is True


def test_the_import_loads_nothing_heavy():
    heavy = ["numpy", "typing", "roundelay.base"]
    assert fresh(f"import sys; print(json.dumps([n for n in {heavy} if n in sys.modules]))") == []


def test_the_stub_names_each_name_once():
    lines = [line for line in (ROOT / "__init__.pyi").read_text().splitlines() if line[0] != "#"]
    for line in lines:
        _, _, _, name, _, again = line.split()
        assert name == again
    assert len({line.split()[3] for line in lines}) == len(lines)


def modules() -> Iterator[str]:
    """All modules but the package itself, its entry and the commands, which nobody imports."""
    for path in sorted(ROOT.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        if parts[0] not in ("__init__", "__main__", "cli", "commands"):
            yield ".".join(("roundelay", *parts)).removesuffix(".__init__")


@pytest.mark.parametrize("name", list(modules()))
def test_all_is_what_is_public(name):
    """Functions and classes; a package may import what it only registers."""
    module = importlib.import_module(name)
    body = ast.parse(Path(module.__file__ or "").read_text()).body
    own = {one.name for one in body if isinstance(one, ast.FunctionDef | ast.ClassDef)}
    listed = getattr(module, "__all__", ())
    assert {one for one in own if one[0] != "_"} <= set(listed)
    assert all(hasattr(module, one) for one in listed)


def bound(name: str) -> Iterator[str]:
    """What a module defines, and what a package takes from its own modules."""
    path = Path(importlib.import_module(name).__file__ or "")
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (target.id for target in targets if isinstance(target, ast.Name))
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith(f"{name}."):
            yield from (alias.asname or alias.name for alias in node.names)


@pytest.mark.parametrize("name", PUBLIC_MODULES)
def test_all_of_a_public_module_is_what_it_binds(name):
    listed = importlib.import_module(name).__all__
    assert {one for one in bound(name) if one[0] != "_"} == set(listed)
    assert len(set(listed)) == len(listed)


READ_BY_OTHERS = """
    read write find_cycles find_periodic segment concatenate NoPeriod RoundelayError Options
    synth.gait synth.sequence synth.wander topology.persistent_cohomology
"""


@pytest.mark.parametrize("name", READ_BY_OTHERS.split())
def test_names_that_others_read_stay(name):
    found = rl
    for part in name.split("."):
        found = getattr(found, part)
    assert callable(found)


def test_attributes_that_others_read_stay():
    motion = synth.gait("walk").motion
    cycle = rl.find_cycles(motion)[0]
    assert cycle.period > 0.0
    assert len(cycle.sample(30)) > 10
    assert 0.0 <= cycle.evidence.confidence <= 1.0
    assert motion.positions().shape == (len(motion), motion.skeleton.n_joints, 3)
    assert (motion.fps, motion.up) == (120.0, 1)
    found = rl.segment(motion)
    assert (len(found.bouts()), len(found.labels)) == (1, len(motion))
