"""Fill in the figures of the README and the documentation from ``benchmarks/results/``.

Usage: python -m benchmarks.figures

Two marks say which text is filled in; neither is seen when a page is rendered. Within a line, a
comment holds the template of the text up to the next comment::

    A library of <!-- {signatures.library.loops} -->117<!-- / --> loops

Before a table, a comment that begins with ``figures`` holds the template of the whole table.

``{NAME.PATH}`` is the figure at a path of keys in the summary of ``results/NAME.json``. After a
colon, ``.2f`` asks for two decimals, ``2`` for two significant digits. Thousands get a comma, and
no zero stands before the point.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import Any

from benchmarks._harness import RESULTS, ROOT, figure

FIGURE = re.compile(r"\{(\w+)\.([^{}]+?)(?::(\.\d+f|\d))?\}")
TABLE = re.compile(r"<!-- figures\n(?P<template>(?:\|.*\n)+)-->\n\n(?P<text>(?:\|.*\n)+)")
INLINE = re.compile(r"<!-- (?P<template>[^\n]*?\{[^\n]*?) -->(?P<text>[^\n]*?)<!-- / -->")
MARKS = (TABLE, INLINE)


def main() -> None:
    for page in pages():
        text = page.read_text()
        if text != (right := filled(text)):
            page.write_text(right)
            print(f"{page.relative_to(ROOT)}: filled in")


def pages() -> list[Path]:
    """The README and the pages of the documentation."""
    pages = (ROOT / "docs").rglob("*.md")
    return [ROOT / "README.md", *sorted(page for page in pages if "_made" not in page.parts)]


def filled(text: str) -> str:
    """Put the figures of the results into a page's marked texts."""
    for mark in MARKS:
        text = mark.sub(_renewed, text)
    return text


def differences(text: str) -> Iterator[str]:
    """Say where a page's marked texts are not what the results give."""
    for mark in MARKS:
        for found in mark.finditer(text):
            right = rendered(found["template"])
            lines = zip_longest(found["text"].split("\n"), right.split("\n"))
            for ours, theirs in lines:
                if ours != theirs:
                    yield f"expected {theirs!r}, found {ours!r}"


def rendered(template: str) -> str:
    """Fill in a template.

    Raises
    ------
    KeyError
        If the results hold no such figure.
    """
    return FIGURE.sub(lambda found: _shown(*found.groups()), template)


def _renewed(found: re.Match[str]) -> str:
    whole, start, end = found[0], *(place - found.start() for place in found.span("text"))
    return whole[:start] + rendered(found["template"]) + whole[end:]


def _shown(name: str, path: str, spec: str | None) -> str:
    value = figure(_summary(name), path)
    if isinstance(value, str):
        return value
    if value is None or isinstance(value, dict | list):
        raise KeyError(f"expected a figure at {path} in the summary of {name}.json, found none")
    if spec is None:
        text = f"{value:,}"
    elif spec.startswith("."):
        text = f"{value:,{spec}}"
    else:
        text = _significant(value, int(spec))
    return re.sub(r"^(-?)0\.", r"\1.", text)


def _significant(value: float, digits: int) -> str:
    if value == 0:
        return "0"
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{round(value, decimals):,.{max(decimals, 0)}f}"


@cache
def _summary(name: str) -> dict[str, Any]:
    path = RESULTS / f"{name}.json"
    return json.loads(path.read_text())["summary"] if path.exists() else {}


if __name__ == "__main__":
    main()
