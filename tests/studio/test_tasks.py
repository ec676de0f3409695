"""The five tasks of the studio in a real Chromium, by mouse and by the keyboard alone.

Each counts its actions: a click, a drag, a key or a combination of keys, a choice of a list. Of
each there are three at most.
"""

from __future__ import annotations

import json
import zipfile

import pytest

import roundelay as rl
from roundelay.studio.work import Work

MOST = 3


class Actions:
    """What a person does, counted."""

    def __init__(self, page) -> None:
        self.page, self.done = page, 0

    def __enter__(self) -> Actions:
        return self

    def __exit__(self, fault, *_: object) -> None:
        assert fault or 0 < self.done <= MOST, f"{self.done} actions"

    def click(self, selector: str) -> None:
        self.done += 1
        self.page.click(selector)

    def press(self, key: str) -> None:
        self.done += 1
        self.page.keyboard.press(key)

    def choose(self, selector: str, value: str) -> None:
        self.done += 1
        self.page.select_option(selector, value)

    def drag(self, selector: str, by: float) -> None:
        self.done += 1
        box = self.page.locator(selector).first.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + by / 2, y)
        self.page.mouse.move(x + by, y)
        self.page.mouse.up()


def loops_are_judged(page, count: int) -> None:
    page.wait_for_selector(f".card:nth-child({count})[data-state=judged]")
    page.wait_for_selector(".card:not([data-state=judged])", state="detached")
    page.wait_for_selector("#bar", state="hidden")


def dropped(page, path) -> None:
    page.set_input_files("#files", path)
    loops_are_judged(page, 2)


def kept(studio, path) -> Work:
    return rl.read_work(studio.folder / f"{path.stem}.work.json")


def spans_of(page) -> list[list[int]]:
    return page.evaluate("""() => [...document.querySelectorAll(".handle")].map(
        (one) => Number(one.getAttribute("aria-valuenow")))""")


def is_kept(page, studio, path, check) -> None:
    """Wait until the work on the disk is as it should be."""
    for _ in range(100):
        if (studio.folder / f"{path.stem}.work.json").is_file() and check(kept(studio, path)):
            return
        page.wait_for_timeout(100)
    raise AssertionError(kept(studio, path))


def test_drop_by_mouse(visit, two_file):
    page = visit().page
    data = two_file.read_text()
    # What a person drags is one file.
    transfer = page.evaluate_handle(
        """(text) => { const held = new DataTransfer();
        held.items.add(new File([text], "two.bvh")); return held; }""",
        data,
    )
    page.dispatch_event("body", "drop", {"dataTransfer": transfer})
    loops_are_judged(page, 2)
    assert "two.bvh" in page.inner_text("#summary")
    assert [one.split("\n")[0] for one in page.locator(".card").all_inner_texts()] == [
        "Motion 1",
        "Motion 2",
    ]
    assert page.get_attribute("#play", "aria-label") == "Pause"


def test_drop_by_keyboard(visit, two_file):
    page = visit().page
    with Actions(page) as actions, page.expect_file_chooser() as chooser:
        page.wait_for_timeout(300)  # until the browser asks us instead of a person
        actions.press("u")
    chooser.value.set_files(two_file)
    loops_are_judged(page, 2)


def test_mend_a_cut_by_mouse(visit, two_file, studio):
    page = visit().page
    dropped(page, two_file)
    before = spans_of(page)
    with Actions(page) as actions:
        actions.drag(".handle.last", -40)
    loops_are_judged(page, 2)
    after = spans_of(page)
    assert after[1] < before[1]
    assert after[0] == before[0]
    is_kept(page, studio, two_file, lambda work: work.parts[0].spans[0][1] == after[1])
    page.click("#undo")
    assert spans_of(page) == before
    is_kept(page, studio, two_file, lambda work: work.parts[0].motion == 1)
    page.click("#redo")
    assert spans_of(page) == after


def test_mend_a_cut_by_keyboard(visit, two_file, studio):
    page = visit().page
    dropped(page, two_file)
    before = spans_of(page)
    page.locator(".handle").first.focus()
    with Actions(page) as actions:
        actions.press("Shift+ArrowRight")
        actions.press("ArrowRight")
    loops_are_judged(page, 2)
    assert spans_of(page)[0] == before[0] + 11
    with Actions(page) as actions:
        actions.press("Control+z")
        actions.press("Control+z")
    assert spans_of(page) == before
    with Actions(page) as actions:
        actions.press("Control+Shift+z")
    assert spans_of(page)[0] == before[0] + 10
    # The frame shown becomes the first.
    with Actions(page) as actions:
        page.locator("#stage").focus()
        actions.press("Shift+ArrowRight")
        actions.press("i")
    assert spans_of(page)[0] > before[0] + 11


@pytest.mark.parametrize("hand", ["mouse", "keyboard"])
def test_choose_a_class(visit, captures, studio, hand):
    page = visit().page
    path = captures / "01_01.bvh"
    dropped(page, path)
    page.wait_for_selector("#class option:nth-child(3)", state="attached")
    before = page.inner_text("#figures")
    with Actions(page) as actions:
        if hand == "mouse":
            actions.click(".card:nth-child(1)")
            actions.choose("#class", "1")
        else:
            actions.press("c")
    is_kept(page, studio, path, lambda work: work.parts[0].class_index is not None)
    loops_are_judged(page, 2)
    assert page.inner_text("#figures") != before


@pytest.mark.parametrize("hand", ["mouse", "keyboard"])
def test_export(visit, two_file, tmp_path, hand):
    page = visit().page
    dropped(page, two_file)
    with Actions(page) as actions, page.expect_download() as download:
        if hand == "mouse":
            actions.click("[data-target=unity]")
        else:
            actions.press("e")
            actions.press("Enter")
    assert download.value.suggested_filename == "two_unity.zip"
    download.value.save_as(tmp_path / "loops.zip")
    with zipfile.ZipFile(tmp_path / "loops.zip") as packed:
        assert packed.namelist() == [
            "Editor/RoundelayImporter.cs",
            "README.txt",
            "two.work.json",
            "two_loop.fbx",
            "two_loop.json",
            "two_loop2.fbx",
        ]
        record = json.loads(packed.read("two_loop.json"))
    assert record["cycles"][0]["playback"]["target"] == "unity"
    assert "two_loop.fbx, two_loop2.fbx" in page.inner_text("#message")


@pytest.mark.parametrize("hand", ["mouse", "keyboard"])
def test_reopen(visit, two_file, studio, hand):
    page = visit().page
    dropped(page, two_file)
    page.fill("#name", "Strides")
    page.keyboard.press("Enter")
    is_kept(page, studio, two_file, lambda work: work.parts[0].name == "Strides")
    # Another window, as after the browser was closed.
    page = visit().page
    with Actions(page) as actions:
        if hand == "mouse":
            actions.click("#takes button")
        else:
            actions.press("l")
            actions.press("Enter")
    loops_are_judged(page, 2)
    assert page.locator(".card b").first.inner_text() == "Strides"


def test_parts_are_renamed_split_merged_made_and_removed(visit, two_file, studio):
    page = visit().page
    dropped(page, two_file)

    def names() -> list[str]:
        return page.locator(".card b").all_inner_texts()

    page.keyboard.press("r")
    page.keyboard.type("Walk")
    page.keyboard.press("Enter")
    assert names() == ["Walk", "Motion 2"]
    page.locator("#stage").focus()
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.press("s")
    assert names() == ["Walk", "Walk 2", "Motion 2"]
    page.keyboard.press("m")
    assert len(names()) == 2
    page.keyboard.press("Control+z")
    # A name that is there makes both one.
    page.locator(".card").nth(1).click()
    page.fill("#name", "Walk")
    page.keyboard.press("Enter")
    assert names() == ["Walk", "Motion 2"]
    page.locator("#stage").focus()
    page.keyboard.press("n")
    assert names() == ["Walk", "Motion 2", "New part 2"]
    page.keyboard.press("Delete")
    assert names() == ["Walk", "Motion 2"]
    is_kept(page, studio, two_file, lambda work: len(work.parts) == 2)


def test_the_words_repeat_the_work(visit, two_file):
    page = visit().page
    dropped(page, two_file)
    page.click("#copy-command")
    assert page.inner_text("#words") == "roundelay loop two.bvh -o loops"
    page.locator(".handle").first.focus()
    page.keyboard.press("ArrowRight")
    loops_are_judged(page, 2)
    page.click("#copy-python")
    assert "rl.read_work('two.work.json').loops()" in page.inner_text("#words")


def test_a_limb_a_period_and_a_start_are_chosen(visit, two_file, studio):
    page = visit().page
    dropped(page, two_file)
    page.select_option("#limbs", "legs")
    page.select_option("#start", "right")
    page.check("#in_place")
    is_kept(
        page,
        studio,
        two_file,
        lambda work: (
            (work.parts[0].limbs, work.parts[0].start, work.render.in_place)
            == ("legs", "right", True)
        ),
    )
    loops_are_judged(page, 2)
    assert page.is_checked("#in_place")


def test_rubbish_and_giants_are_one_line(visit, studio, tmp_path):
    page = visit().page
    path = tmp_path / "bad.bvh"
    path.write_bytes(b"rubbish")
    page.set_input_files("#files", path)
    page.wait_for_selector("#message:not([hidden])")
    assert page.inner_text("#message").startswith("bad.bvh")
    assert "\n" not in page.inner_text("#message")
    giant = tmp_path / "giant.bvh"
    with giant.open("wb") as file:
        file.truncate(500_000_000)
    page.set_input_files("#files", giant)
    page.wait_for_selector("#message >> text=found 500 MB")
    assert not (studio.folder / "giant.bvh").exists()


def test_long_work_is_stopped(visit, two_file):
    page = visit().page
    page.set_input_files("#files", two_file)
    page.wait_for_selector("#bar:not([hidden])")
    page.keyboard.press("Escape")
    page.wait_for_selector("#bar", state="hidden")
    page.set_input_files("#files", two_file)
    loops_are_judged(page, 2)


def test_two_windows_on_one_work(visit, two_file, studio):
    first = visit().page
    dropped(first, two_file)
    first.fill("#name", "Mine")
    first.keyboard.press("Enter")
    is_kept(first, studio, two_file, lambda work: work.parts[0].name == "Mine")
    second = visit()
    second.page.click("#takes button")
    loops_are_judged(second.page, 2)
    first.fill("#name", "Mine again")
    first.keyboard.press("Enter")
    is_kept(first, studio, two_file, lambda work: work.parts[0].name == "Mine again")
    second.page.fill("#name", "Theirs")
    second.page.keyboard.press("Enter")
    second.page.wait_for_selector("#message >> text=another window has changed this work")
    assert kept(studio, two_file).parts[0].name == "Mine again"
    # The browser tells its console of the refusal, too.
    assert all("409" in text for text in second.complaints)
    second.complaints.clear()


def test_everything_has_a_name(visit, two_file):
    page = visit().page
    dropped(page, two_file)
    unnamed = page.evaluate("""() => [...document.querySelectorAll(
        "button, input, select, a[href], [role=slider], [role=radiogroup], [role=img], dialog")]
        .filter((element) => !(element.ariaLabel || element.textContent.trim()
        || element.labels?.[0]?.textContent.trim() || element.getAttribute("aria-labelledby")))
        .map((element) => element.outerHTML)""")
    assert unnamed == []


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 820, 1440])
def test_nothing_sticks_out(visit, two_file, width, theme, tmp_path):
    page = visit(width=width, height=900, color_scheme=theme).page
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    dropped(page, two_file)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate("document.documentElement.dataset.theme") == theme
    page.screenshot(path=tmp_path / "studio.png", full_page=True)
