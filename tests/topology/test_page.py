"""The page of the documentation says what its examples print."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any

from roundelay import topology

PAGE = Path(__file__).parents[2] / "docs" / "topology.md"


def test_the_examples_print_what_the_page_says() -> None:
    blocks = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) == PAGE.read_text().count("```python") > 3
    names: dict[str, Any] = {}
    for code, expected in blocks:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)
        assert printed.getvalue() == expected


def test_every_public_name_is_on_the_page() -> None:
    listed = PAGE.read_text().partition("## All names")[2]
    for name in set(topology.__all__) - {"Metric", "Runs"}:
        assert f"`{name}`" in listed, name
