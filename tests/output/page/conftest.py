"""Pages in a real Chromium."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.chromium import Seen, visits

import roundelay as rl
from roundelay import synth
from roundelay.output.page import build_page

WITHIN = ("file:", "data:", "blob:")


@pytest.fixture(scope="session")
def page_file(tmp_path_factory, jumps, jump_loops) -> Path:
    return _saved(tmp_path_factory, build_page(jumps, jump_loops))


@pytest.fixture(scope="session")
def several_file(tmp_path_factory) -> Path:
    parts = [synth.gait("walk", repetitions=4), synth.gait("punch", repetitions=5)]
    motion = synth.sequence(*parts).motion
    return _saved(tmp_path_factory, build_page(motion, rl.make_loops(motion)))


@pytest.fixture(scope="session")
def refused_file(tmp_path_factory, boxing) -> Path:
    with pytest.raises(rl.NoPeriod) as refusal:
        rl.find_cycles(boxing[:600])
    return _saved(tmp_path_factory, build_page(boxing[:600], refusal=refusal.value))


def _saved(tmp_path_factory, text: str) -> Path:
    path = tmp_path_factory.mktemp("page") / "page.html"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def visit(chromium) -> Iterator[Callable[..., Seen]]:
    """Open a file; at the end, it must have complained of nothing and asked for nothing."""
    with visits(chromium, WITHIN) as visited:
        yield lambda path, **how: visited(path.as_uri(), **how)
