"""Sphinx configuration; the gallery's examples and all lists are made on build."""

from __future__ import annotations

import ast
import json
import runpy
import sys
from itertools import groupby
from pathlib import Path
from typing import Any

import latex2mathml.converter
from docutils.nodes import SkipNode

import roundelay
from roundelay.base.thresholds import constants

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
ROOT = HERE.parent

project = "roundelay"
author = "The roundelay developers"
copyright = "the roundelay developers"
version = release = roundelay.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "numpydoc",
]
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3
numpydoc_show_class_members = False
default_role = "py:obj"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
exclude_patterns = [
    "_made/benchmarks.md",
    "_made/options.md",
    "_made/schema.md",
    "_made/thresholds.md",
    "_made/tree.md",
]
html_theme = "furo"
html_title = "roundelay"
html_static_path: list[str] = []
templates_path = ["_templates"]
html_sidebars = {
    "**": [
        "sidebar/brand.html",
        "sidebar/search.html",
        "sidebar/scroll-start.html",
        "sidebar/navigation.html",
        "sidebar/versions.html",
        "sidebar/scroll-end.html",
    ]
}
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#33415c", "color-brand-content": "#c33c50"},
    "dark_css_variables": {"color-brand-primary": "#c9d2e2", "color-brand-content": "#f4808c"},
}


# Formulas become MathML on build, so that the pages ask nothing of the network.
html_math_renderer = "mathml"


def setup(app: Any) -> None:
    """Make the generated pages before Sphinx reads; render formulas."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_inline_formula, None), block_renderers=(_formula, None)
    )
    app.connect("autodoc-process-docstring", _plain_bars, priority=400)
    made = HERE / "_made"
    made.mkdir(exist_ok=True)
    (made / ".gitignore").write_text("*\n")
    app.connect("builder-inited", lambda _: _gallery(made))
    app.connect("builder-inited", lambda _: _benchmarks(made))
    app.connect("builder-inited", lambda _: _tree(made))
    app.connect("builder-inited", lambda _: _thresholds(made))
    app.connect("builder-inited", lambda _: _options(made))


def _plain_bars(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Let |x| in docstrings be a norm, not a substitution."""
    lines[:] = [line if "``" in line else line.replace("|", r"\|") for line in lines]


def _inline_formula(translator: Any, node: Any) -> None:
    translator.body.append(latex2mathml.converter.convert(node.astext()))
    raise SkipNode


def _formula(translator: Any, node: Any) -> None:
    formula = latex2mathml.converter.convert(node.astext(), display="block")
    translator.body.append(f'<div class="math">{formula}</div>\n')
    raise SkipNode


def _gallery(made: Path) -> None:
    """Run every example; show its text, its code, what it printed and what it drew."""
    pages = ["# Gallery", "Each example is run when these pages are built.", ""]
    for path in sorted((ROOT / "examples").glob("*.py")):
        tree = ast.parse(path.read_text())
        title, _, text = (ast.get_docstring(tree) or "").partition("\n")
        printed = _printed(path, made)
        pages += [f"## {title.rstrip('.')}", text.strip(), ""]
        pages += [f"```{{literalinclude}} ../../examples/{path.name}", ":language: python"]
        pages += [f":lines: {tree.body[1].lineno}-", "```", ""]
        pages += ["```text", printed.rstrip(), "```", ""] if printed.strip() else []
        for picture in sorted(made.glob(f"{path.stem}*.[ps][nv]g")):
            pages += [f"![{title}]({picture.name})", ""]
    (made / "gallery.md").write_text("\n".join(pages))


def _printed(path: Path, made: Path) -> str:
    """Run an example with its folder for pictures; return what it printed."""
    import contextlib
    import io

    said, before = io.StringIO(), sys.argv
    sys.argv = [str(path), str(made)]
    try:
        with contextlib.redirect_stdout(said):
            runpy.run_path(str(path), run_name="__main__")
    finally:
        sys.argv = before
    return said.getvalue()


def _benchmarks(made: Path) -> None:
    """List the benchmarks by their own words."""
    pages = []
    for path in sorted((ROOT / "benchmarks").glob("*.py")):
        text = ast.get_docstring(ast.parse(path.read_text())) or ""
        if f"python -m benchmarks.{path.stem}" in text:
            pages += [f"## {path.stem}", "```text", text, "```", ""]
    (made / "benchmarks.md").write_text("\n".join(pages))


def _tree(made: Path) -> None:
    """List the modules with the first line of what each says of itself."""
    package, rows = ROOT / "src" / "roundelay", []
    for path in sorted(package.rglob("*.py"), key=_folders_last):
        line = (ast.get_docstring(ast.parse(path.read_text())) or "").partition("\n")[0]
        if path.name != "__init__.py" and line:
            rows.append(f"| `{path.relative_to(package)}` | {line.replace('``', '`')} |")
    (made / "tree.md").write_text("\n".join(["| module | |", "|---|---|", *rows, ""]))


def _thresholds(made: Path) -> None:
    """List the constants that decide results, a table a record, with what moving them changes."""
    measured = json.loads((ROOT / "benchmarks" / "results" / "sensitivity.json").read_text())
    moved = {row["name"]: row for row in measured["constants"]}
    pages: list[str] = []
    for record, inside in groupby(constants(), key=lambda one: one.name.rpartition(".")[0]):
        rows = list(inside)
        about = type(rows[0].record).__doc__ or ""
        pages += [f"## {record}", "", about, ""]
        pages += ["| constant | value | unit | origin | margin |", "|---|---|---|---|---|"]
        for one in rows:
            margin = "; ".join(filter(None, (one.margin, _moved(moved.get(one.name)))))
            cells = (f"`{one.field}`", _shown(one.value), one.unit, one.origin, margin)
            pages.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
        pages.append("")
    (made / "thresholds.md").write_text("\n".join(pages))


def _shown(value: Any) -> str:
    return ", ".join(map(_shown, value)) if isinstance(value, tuple) else f"{value:g}"


def _moved(row: dict[str, Any] | None) -> str:
    """Say what a fifth less and a fifth more of a constant changes."""
    if row is None:
        return ""
    less, more = (sum(row[label].values()) for label in ("x0.8", "x1.2"))
    count = row["captures"]
    if not less and not more:
        return f"changes none of {count}"
    return f"x.8 changes {less}, x1.2 {more} of {count}"


def _options(made: Path) -> None:
    """Write the tables of options."""
    from tables import schema, tables

    (made / "options.md").write_text(tables())
    (made / "schema.md").write_text(schema())


def _folders_last(path: Path) -> tuple[str, str]:
    inside = path.relative_to(ROOT / "src" / "roundelay")
    return (str(inside.parent) if len(inside.parts) > 1 else "", inside.name)
