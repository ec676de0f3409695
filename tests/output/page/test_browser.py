"""The page in a real headless Chromium."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import roundelay as rl

TWO_FRAMES = "requestAnimationFrame(() => requestAnimationFrame(done))"


def picture(page, name: str) -> str:
    """The pixels of a canvas, once what is due has been drawn."""
    page.evaluate(
        "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )
    return page.evaluate(f"() => document.getElementById('{name}').toDataURL()")


def seconds(page) -> float:
    return float(page.get_attribute("#timeline", "aria-valuenow"))


def shown_view(page) -> str:
    return page.locator("#views input:checked").get_attribute("value")


def test_everything_is_there(visit, page_file, jump_cycles):
    page = visit(page_file).page
    assert page.title() == "01_01 · roundelay"
    assert "2752 frames at 120 fps" in page.inner_text("#summary")
    for card in ("facts", "bars", "plane", "quality"):
        assert page.is_visible(f"#{card}-card"), card
    assert not page.is_visible("#notice")
    # Jumps of two tempos are two motions.
    assert page.is_visible("#motions-card")
    period = jump_cycles[0].period
    assert f"{period:.2f} s" in page.inner_text("#facts")
    assert page.locator("#quality tr").count() >= 5
    assert page.locator("#bars input").count() >= 2


def test_everything_has_a_name(visit, page_file):
    page = visit(page_file).page
    unnamed = page.evaluate("""() => [...document.querySelectorAll(
        "button, input, select, a, canvas, [role=radiogroup], dialog")].filter((element) =>
        !(element.ariaLabel || element.textContent.trim() || element.labels?.[0]?.textContent.trim()
        || element.getAttribute("aria-labelledby"))).map((element) => element.outerHTML)""")
    assert unnamed == []
    tree = page.locator("body").aria_snapshot()
    for name in ('button "Play"', 'slider "Time in the capture"', 'radio "Side by side"'):
        assert name in tree


def test_playing_goes_on(visit, page_file):
    page = visit(page_file).page
    start, before = seconds(page), picture(page, "stage")
    page.click("#play")
    page.wait_for_timeout(700)
    assert page.get_attribute("#play", "aria-label") == "Pause"
    page.keyboard.press("k")
    page.click("#play")
    stopped = seconds(page)
    assert 0.3 < stopped - start < 3.0
    assert picture(page, "stage") != before
    page.wait_for_timeout(150)
    assert seconds(page) == stopped


def test_the_keyboard_does_it_all(visit, page_file):
    page = visit(page_file).page
    press = page.keyboard.press
    press(" ")
    assert page.get_attribute("#play", "aria-label") == "Pause"
    press(" ")
    press("Home")
    assert seconds(page) == 0.0
    press("ArrowRight")
    assert seconds(page) == pytest.approx(4 / 120, abs=0.006)
    press("Shift+ArrowRight")
    assert seconds(page) == pytest.approx(1 + 4 / 120, abs=0.006)
    press("End")
    assert seconds(page) == pytest.approx(2751 / 120, abs=0.006)
    press("[")
    assert seconds(page) < 2700 / 120
    for key, view in {"2": "loop", "3": "beside", "4": "overlay", "1": "capture"}.items():
        press(key)
        assert shown_view(page) == view
    press("b")
    assert shown_view(page) == "loop"
    press("b")
    press("+")
    assert page.input_value("#speed") == "2"
    press("o")
    assert page.is_checked("#onion")
    press("f")
    assert not page.is_checked("#follow")
    press("?")
    assert page.is_visible("#help")
    press("Escape")
    assert not page.is_visible("#help")


def test_views_differ(visit, page_file):
    page = visit(page_file).page
    page.keyboard.press("Shift+ArrowRight")
    pictures = set()
    for view in ("capture", "loop", "beside", "overlay"):
        page.locator(f"#views label:has([value={view}])").click()
        pictures.add(picture(page, "stage"))
    page.keyboard.press("o")
    pictures.add(picture(page, "stage"))
    assert len(pictures) == 5


def test_a_class_changes_the_picture(visit, page_file):
    page = visit(page_file).page
    before = [picture(page, name) for name in ("timeline", "plane")]
    page.locator("#bars label").nth(1).click()
    after = [picture(page, name) for name in ("timeline", "plane")]
    assert all(old != new for old, new in zip(before, after, strict=True))
    assert page.locator("#bars label").nth(1).get_attribute("class") == "bar selected"
    page.keyboard.press("ArrowUp")
    assert page.locator("#bars input").nth(0).is_checked()


def test_looking_around(visit, page_file):
    page = visit(page_file).page
    box = page.locator("#stage").bounding_box()
    pictures = [picture(page, "stage")]
    page.mouse.move(box["x"] + 300, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 400, box["y"] + 230)
    page.mouse.up()
    pictures.append(picture(page, "stage"))
    page.mouse.wheel(0, 300)
    pictures.append(picture(page, "stage"))
    assert len(set(pictures)) == 3
    page.keyboard.press("r")
    assert picture(page, "stage") == pictures[0]


def test_scrubbing(visit, page_file):
    page = visit(page_file).page
    box = page.locator("#timeline").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 60)
    assert seconds(page) == pytest.approx(2751 / 240, abs=0.1)


def test_themes(visit, page_file):
    dark = visit(page_file, color_scheme="dark").page
    light = visit(page_file, color_scheme="light").page
    theme = "document.documentElement.dataset.theme"
    assert (dark.evaluate(theme), light.evaluate(theme)) == ("dark", "light")
    before = picture(light, "stage")
    light.click("#theme")
    assert light.evaluate(theme) == "dark"
    assert picture(light, "stage") != before


@pytest.mark.parametrize("width", [360, 768, 1280])
def test_nothing_sticks_out(visit, page_file, width):
    page = visit(page_file, width=width, height=780).page
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_loop_is_saved(visit, page_file, jump_cycles, tmp_path):
    page = visit(page_file).page
    with page.expect_download() as download:
        page.click("#save")
    assert download.value.suggested_filename == "01_01_loop.bvh"
    path: Path = tmp_path / "saved.bvh"
    download.value.save_as(path)
    saved, loop = rl.read(path), jump_cycles[0].sample()
    assert len(saved) == len(loop)
    assert np.allclose(saved.positions(), loop.positions(), atol=1e-4 * loop.skeleton.size)
    assert saved.frame_time == pytest.approx(loop.frame_time)


def test_several_motions(visit, several_file):
    page = visit(several_file).page
    assert page.locator("#motions input").count() == 2
    facts, before = page.inner_text("#facts"), picture(page, "plane")
    page.locator("#motions label").nth(1).click()
    assert page.inner_text("#facts") != facts
    assert picture(page, "plane") != before
    assert page.get_attribute("#save", "download").endswith("_loop2.bvh")


def test_no_period_is_said(visit, refused_file):
    page = visit(refused_file).page
    assert page.is_visible("#notice")
    assert re.search(r"turns|bar|period|pose", page.inner_text("#reasons"))
    assert not page.is_visible("#quality-card")
    assert not page.is_visible("#views")
    start = seconds(page)
    page.keyboard.press(" ")
    page.wait_for_timeout(400)
    assert seconds(page) > start
    page.keyboard.press("3")
    assert shown_view(page) == "capture"
