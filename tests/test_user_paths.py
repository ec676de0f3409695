"""Benchmarks measure what users run: what they import is public, or used on the way from there.

A graph of names is read from the sources, without running them: a function, class or constant of
the package points to the names that its body refers to. What is reached from the command line,
the pipeline and the public names lies on a user's path. The papers' own methods, in
`roundelay.reproduction`, lie on none but `roundelay reproduce`, which is for them: a benchmark may
run them in the functions that its ``LABELLED`` lists, each with a label that names the paper. Of
`roundelay.topology`, a library of its own, only what the search uses counts, unless so labelled.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

import roundelay
from roundelay import segmentation, synth

ROOT = Path(__file__).parent.parent
BENCHMARKS = {path.stem: path for path in sorted((ROOT / "benchmarks").glob("*.py"))}
PAPERS = "roundelay.reproduction"
# The command that shows them makes none of what users are given.
REPRODUCE = ("roundelay.commands.reproduce", "reproduce")
# What varies constants measures nothing by itself.
INSTRUMENTS = ("roundelay.base.thresholds",)
PUBLIC = (roundelay, segmentation, synth)

Name = tuple[str, str]


@dataclass(frozen=True)
class Module:
    """What the names of a module stand for."""

    name: str
    tree: ast.Module

    @property
    def imported(self) -> dict[str, Name]:
        """Where its imported names are from; a module has an empty name."""
        found = {}
        for node in ast.walk(self.tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    found[alias.asname or alias.name] = (node.module, alias.name)
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    found[alias.asname or alias.name] = (alias.name, "")
        return found

    @property
    def defined(self) -> dict[str, list[ast.stmt]]:
        """Its own names with the statements that make them; "" for the rest, which always runs."""
        found: dict[str, list[ast.stmt]] = {"": []}
        for node in self.tree.body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                names = [node.name]
            elif isinstance(node, ast.Assign | ast.AnnAssign):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                names = [target.id for target in targets if isinstance(target, ast.Name)] or [""]
            else:
                names = [] if isinstance(node, ast.Import | ast.ImportFrom) else [""]
            for name in names:
                found.setdefault(name, []).append(node)
        return found


class Names:
    """The names of a package and what each refers to."""

    def __init__(self, folder: Path) -> None:
        self.modules = {}
        for path in folder.rglob("*.py"):
            parts = path.relative_to(folder.parent).with_suffix("").parts
            name = ".".join(parts[: -1 if parts[-1] == "__init__" else None])
            self.modules[name] = Module(name, ast.parse(path.read_text()))
        self.imported = {name: module.imported for name, module in self.modules.items()}
        self.defined = {name: module.defined for name, module in self.modules.items()}

    def home(self, name: Name) -> Name:
        """Follow a name to the module that makes it."""
        module, own = name
        if not own or own in self.defined.get(module, {}) or module not in self.modules:
            return name
        if f"{module}.{own}" in self.modules:
            return f"{module}.{own}", ""
        return self.home(self.imported[module][own]) if own in self.imported[module] else name

    def referred(self, nodes: list[ast.stmt], module: str, imported: dict[str, Name]) -> set[Name]:
        """The package's names that statements refer to."""
        own = self.defined.get(module, {})
        found = set()
        for node in (one for statement in nodes for one in ast.walk(statement)):
            if isinstance(node, ast.Name) and node.id in own:
                found.add((module, node.id))
            elif isinstance(node, ast.Name) and node.id in imported:
                found.add(self.home(imported[node.id]))
            elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                base = self.home(imported.get(node.value.id, ("", "")))
                if base[0] and not base[1]:
                    found.add(self.home((base[0], node.attr)))
        return {name for name in found if name[0].partition(".")[0] == "roundelay"}

    def reached(self, starts: set[Name]) -> set[Name]:
        """All names on a way from some."""
        waiting, seen = set(starts), set()
        while waiting:
            name = waiting.pop()
            seen.add(name)
            module, own = name
            nodes = self.defined.get(module, {}).get(own, [])
            following = self.referred(nodes, module, self.imported.get(module, {}))
            waiting |= ({(module, "")} | following) - seen - {REPRODUCE}
        return seen


@pytest.fixture(scope="module")
def names() -> Names:
    return Names(ROOT / "src" / "roundelay")


@pytest.fixture(scope="module")
def users(names) -> set[Name]:
    """Every name on a user's path."""
    starts = {
        (module, own)
        for module in names.modules
        if module == "roundelay.pipeline" or module.startswith(("roundelay.cli", "roundelay.comm"))
        for own in names.defined[module]
        if module != REPRODUCE[0]
    }
    public = {
        (getattr(getattr(room, name), "__module__", room.__name__), name)
        for room in PUBLIC
        for name in room.__all__
    }
    return names.reached(starts | {names.home(name) for name in public})


def astray(text: str, names: Names, users: set[Name]) -> Iterator[str]:
    """What a benchmark runs of the package that no user does, but for papers' own methods."""
    benchmark = Module("benchmark", ast.parse(text))
    papers_own = next(
        (
            ast.literal_eval(nodes[0].value)
            for name, nodes in benchmark.defined.items()
            if name == "LABELLED"
        ),
        {},
    )
    allowed = {
        own
        for own, label in papers_own.items()
        if label.startswith(("[A]", "[B]", "[C]", "roundelay.topology"))
    }
    for own, nodes in benchmark.defined.items():
        for module, name in sorted(names.referred(nodes, "benchmark", benchmark.imported)):
            public = module == "roundelay" and name in ("", *roundelay.__all__)
            known = public or module in INSTRUMENTS or (module, name) in users
            if name and not known and own not in allowed:
                yield f"{own}: {module}.{name}"


@pytest.mark.parametrize("name", BENCHMARKS)
def test_benchmarks_measure_what_users_run(name, names, users):
    assert list(astray(BENCHMARKS[name].read_text(), names, users)) == []


def test_the_search_lies_on_a_users_path_and_reproductions_do_not(users):
    assert ("roundelay.timeline.assembly", "timeline_of") in users
    assert ("roundelay.topology.coordinate", "circular_coordinate") in users
    assert not [name for name in users if name[0].startswith(PAPERS) and name[1]]


def test_a_benchmark_of_what_nobody_runs_is_noticed(names, users):
    imported = "from roundelay.reproduction import raunio\n"
    row = f"{imported}def row():\n    return raunio.extract(values, options)\n"
    assert list(astray(row, names, users)) == ["row: roundelay.reproduction.raunio.extract"]
    labelled = f'{row}LABELLED = {{"row": "[C], rebuilt"}}\n'
    assert list(astray(labelled, names, users)) == []
    assert list(astray(labelled.replace("[C], rebuilt", "ours"), names, users)) != []
