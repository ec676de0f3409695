"""Pages in a real Chromium."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.chromium import Seen

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
    opened, contexts = [], []

    def visit(path: Path, *, width: int = 1280, height: int = 800, **context) -> Seen:
        made = chromium.new_context(viewport={"width": width, "height": height}, **context)
        contexts.append(made)
        seen = Seen(made.new_page())
        opened.append(seen)
        seen.page.on("console", lambda said: seen.complaints.append(said.text))
        seen.page.on("pageerror", lambda error: seen.complaints.append(str(error)))
        seen.page.on("request", lambda asked: seen.requests.append(asked.url))
        seen.page.goto(path.as_uri())
        seen.page.wait_for_selector("body[data-ready]", timeout=20_000)
        return seen

    yield visit
    complaints = [text for seen in opened for text in seen.complaints]
    asked = [url for seen in opened for url in seen.requests]
    for context in contexts:
        context.close()
    assert complaints == []
    assert [url for url in asked if not url.startswith(WITHIN)] == []
