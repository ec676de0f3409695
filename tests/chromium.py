"""A real headless Chromium, or a reason why not."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import pytest

ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@dataclass
class Seen:
    """A page in the browser, with what it complained of and asked for."""

    page: object
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@pytest.fixture(scope="session")
def chromium() -> Iterator[object]:
    driver = pytest.importorskip(
        "playwright.sync_api", reason="needs Playwright: pip install playwright"
    )
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("needs Chromium: apt-get install chromium")
    with driver.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        yield browser
        browser.close()


@contextmanager
def visits(browser, own: tuple[str, ...]) -> Iterator[Callable[..., Seen]]:
    """Open addresses; at the end none complained, or asked for what does not begin as its own."""
    opened, contexts = [], []

    def visit(url: str, *, width: int = 1280, height: int = 800, **context) -> Seen:
        made = browser.new_context(viewport={"width": width, "height": height}, **context)
        contexts.append(made)
        seen = Seen(made.new_page())
        opened.append(seen)
        seen.page.set_default_timeout(25_000)
        seen.page.on("console", lambda said: seen.complaints.append(said.text))
        seen.page.on("pageerror", lambda error: seen.complaints.append(str(error)))
        seen.page.on("request", lambda asked: seen.requests.append(asked.url))
        seen.page.goto(url)
        seen.page.wait_for_selector("body[data-ready]")
        return seen

    yield visit
    complaints = [text for seen in opened for text in seen.complaints]
    asked = [url for seen in opened for url in seen.requests]
    for context in contexts:
        context.close()
    assert complaints == []
    assert [url for url in asked if not url.startswith(own)] == []
