"""Rooms, arrows and functions of a source tree; of two, before and after.

Usage: python -m benchmarks.house [BEFORE] [NOW] [--json] [--keep]

A room is a package or a module at the top of the tree (src/roundelay by default); an arrow goes
from a room to another that one of its modules imports. Public functions are those of modules and
of public classes without an underscore in front; the length of a body leaves its docstring out.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks._harness import ROOT, Target, parser, report

Function = ast.FunctionDef | ast.AsyncFunctionDef
TARGETS = (
    Target("now.median_body", "<=", 6, "lines of a function's body, median"),
    Target("now.longest_body", "<=", 39, "lines of the longest body"),
)


def main() -> None:
    options = parser(__doc__, data=None)
    options.add_argument("folders", nargs="*", type=Path, default=[ROOT / "src" / "roundelay"])
    arguments = options.parse_args()
    folders = arguments.folders
    if len(folders) > 2:
        options.error(f"expected one folder or two, found {len(folders)}")
    names = ("before", "now")[-len(folders) :]
    summary = {name: counted(folder) for name, folder in zip(names, folders, strict=True)}
    keys = summary["now"]
    table = (f"{key:18}" + "".join(f"{summary[x][key]:>10}" for x in names) for key in keys)
    report("house", {"summary": summary}, TARGETS, arguments, table=table)


def counted(folder: Path) -> dict[str, Any]:
    """Count rooms, arrows, modules, lines, public functions, and lengths of bodies."""
    texts = {path: path.read_text() for path in sorted(folder.rglob("*.py"))}
    trees = {path: ast.parse(text) for path, text in texts.items()}
    bodies = [length for tree in trees.values() for length in lengths(tree)]
    return {
        "rooms": len({room(path, folder) for path in trees} - {""}),
        "arrows": len(arrows(trees, folder)),
        "modules": len(trees),
        "lines": sum(text.count("\n") for text in texts.values()),
        "public_functions": sum(len(list(public(tree))) for tree in trees.values()),
        "functions": len(bodies),
        "median_body": median(bodies),
        "longest_body": max(bodies),
    }


def room(path: Path, folder: Path) -> str:
    """Name the room that a module lies in; none for the package's own entrances."""
    first = path.relative_to(folder).parts[0].removesuffix(".py")
    return "" if first.startswith("__") else first


def arrows(trees: dict[Path, ast.Module], folder: Path) -> set[tuple[str, str]]:
    """Pairs of rooms of which the first imports the second."""
    rooms = {room(path, folder) for path in trees} - {""}
    found = {
        (room(path, folder), name.split(".")[1])
        for path, tree in trees.items()
        for name in imported(tree)
        if name.startswith(f"{folder.name}.")
    }
    return {(one, other) for one, other in found if one in rooms and other in rooms - {one}}


def imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def public(tree: ast.Module) -> Iterator[Function]:
    scopes: list[ast.Module | ast.ClassDef] = [tree]
    scopes += [x for x in tree.body if isinstance(x, ast.ClassDef) and not x.name.startswith("_")]
    for scope in scopes:
        for node in scope.body:
            if isinstance(node, Function) and not node.name.startswith("_"):
                yield node


def lengths(tree: ast.Module) -> Iterator[int]:
    """Lines of every function's body, from its first statement to its last."""
    for node in ast.walk(tree):
        if isinstance(node, Function):
            body = node.body[ast.get_docstring(node) is not None :]
            yield (body[-1].end_lineno or 0) - body[0].lineno + 1 if body else 0


if __name__ == "__main__":
    main()
