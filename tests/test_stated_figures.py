"""Figures of the README and the documentation are those of ``benchmarks/results/``."""

from __future__ import annotations

import re

import pytest
from benchmarks import figures
from benchmarks._harness import ROOT

PAGES = {str(page.relative_to(ROOT)): page for page in figures.pages()}


@pytest.mark.parametrize("name", PAGES)
def test_marked_texts_are_what_the_results_give(name):
    """`make figures` fills them in."""
    assert list(figures.differences(PAGES[name].read_text())) == []


@pytest.mark.parametrize("mark", figures.MARKS)
def test_a_changed_digit_is_noticed(mark):
    """In a table and within a line."""
    text = PAGES["docs/comparison.md"].read_text()
    found = next(one for one in mark.finditer(text) if "loops" in one["template"])
    place = found.start("text") + re.search(r"61", found["text"]).start()
    changed = f"{text[:place]}7{text[place + 1 :]}"
    assert len(list(figures.differences(changed))) == 1
    assert figures.filled(changed) == text


def test_every_mark_is_read():
    """A comment with a figure that the marks do not match would never be filled in."""
    for name, page in PAGES.items():
        text = page.read_text()
        read = sum(len(list(mark.finditer(text))) for mark in figures.MARKS)
        written = re.findall(r"<!-- (?:figures\n|[^\n>]*\{\w+\.)", text)
        assert read == len(written), name
        # A line that starts with a comment would be no part of its paragraph.
        assert not re.search(r"^ *<!-- [^\n]*\{\w+\.", text, re.M), name


def test_figures_of_benchmarks_are_all_marked():
    """In the tables that the pages call a benchmark's."""
    for name in PAGES:
        assert unmarked(PAGES[name].read_text()) == [], name


def test_an_unmarked_figure_is_noticed():
    text = PAGES["docs/comparison.md"].read_text()
    literal = text.replace("| {loops.right} of {loops.captures} |", "| 61 of {loops.captures} |")
    assert unmarked(literal) == ["61"]
    bare = re.sub(r"<!-- figures\n(?:\|.*\n)+-->\n\n", "", text, count=1)
    assert set(unmarked(bare)) == {"51", "60", "61"}


def unmarked(text: str) -> list[str]:
    """Numbers of a benchmark's table that no template gives; first column and brackets aside."""
    shown = figures.INLINE.sub("", text)
    found = []
    for table in figures.TABLE.finditer(shown):
        if of_benchmark(shown[: table.start()], table["text"]):
            found += literals(figures.FIGURE.sub("", table["template"]))
    for table in re.finditer(r"(?:^\|.*\n?)+", figures.TABLE.sub("", shown), re.M):
        if of_benchmark(figures.TABLE.sub("", shown)[: table.start()], table[0]):
            found += literals(table[0])
    return found


def of_benchmark(before: str, table: str) -> bool:
    """Whether a table has a column of benchmarks, or the paragraph before it names one."""
    words = before.rstrip().rpartition("\n\n")[2]
    return "| benchmark |" in table or words.startswith("*Benchmark `")


def literals(table: str) -> list[str]:
    rows = table.strip().split("\n")[2:]
    cells = [re.sub(r"\([^|]*?\)", "", cell) for row in rows for cell in row.split("|")[2:]]
    return [number for cell in cells for number in re.findall(r"\d+", cell)]
