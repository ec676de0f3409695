"""The studio: from a dropped file to its playing loop, from a change to the new loop, drawing.

Usage: python -m benchmarks.studio [--json] [--keep] [--pictures FOLDER]

Made walks of 500 and 20,000 frames are dropped on a studio in headless Chromium that has been
open for a while. Measured are the seconds until the take plays, until a loop plays, until it is
judged; until the loop of a mended cut plays; and the script of one drawn frame, side by side.
Needs ``pip install 'roundelay[studio]' playwright`` and Debian's ``chromium``.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks.page import ARGUMENTS, COUNTER
from roundelay import synth

TARGETS = (
    Target("few.loop", "<=", 1.0, "seconds from 500 dropped frames to a playing loop"),
    Target("many.loop", "<=", 5.0, "seconds from 20,000 dropped frames to a playing loop"),
    Target("many.progress", "==", 1, "progress is shown of 20,000 frames"),
    Target("few.mended", "<=", 0.3, "seconds from a mended cut to the new loop, 500 frames"),
    Target("draw_ms", "<=", 8.0, "milliseconds of script a frame"),
)
JUMPS = Path(__file__).parent.parent / "data" / "captures" / "01_01.bvh"
SIZES = {"phone": (390, 844), "tablet": (820, 1180), "desk": (1440, 900)}


def main() -> None:
    options = parser(__doc__, data=None)
    options.add_argument("--pictures", type=Path, help="where pictures at three sizes go")
    arguments = options.parse_args()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        program = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        takes = _takes(Path(folder))
        summary: dict[str, Any] = {
            name: _measured(browser, path, Path(folder) / name) for name, path in takes.items()
        }
        summary["draw_ms"] = max(row.pop("draw_ms") for row in summary.values())
        if arguments.pictures:
            _pictures(browser, arguments.pictures)
    result = {"summary": summary, "load": list(os.getloadavg())}
    report("studio", result, TARGETS, arguments, table=map(str, summary.items()))


def _takes(folder: Path) -> dict[str, Path]:
    """Write the takes that are dropped."""
    short = synth.gait("walk", repetitions=4.0).motion[:500]
    long = synth.gait("walk", repetitions=160.0).motion[:20_000]
    paths = {}
    for name, motion in {"few": short, "many": long}.items():
        paths[name] = folder / f"{name}_walk.bvh"
        rl.write(motion, paths[name])
    return paths


def _studio(folder: Path) -> tuple[subprocess.Popen[str], str]:
    words = [sys.executable, "-m", "roundelay", "studio", str(folder), "--no-browser"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    return process, process.stdout.readline().split()[-1]


def _measured(browser: Any, path: Path, folder: Path) -> dict[str, Any]:
    process, url = _studio(folder)
    try:
        page = browser.new_page(viewport={"width": 1366, "height": 860})
        page.set_default_timeout(120_000)
        page.add_init_script(COUNTER)
        page.goto(url)
        page.wait_for_selector("body[data-ready]")
        page.wait_for_timeout(4000)  # as a person who looks for a file
        return _dropped(page, path) | {"mended": _mended(page), "draw_ms": _drawn(page)}
    finally:
        process.terminate()
        process.wait()


def _dropped(page: Any, path: Path) -> dict[str, Any]:
    started = time.perf_counter()

    def passed(selector: str) -> float:
        page.wait_for_selector(selector, state="attached")
        return round(time.perf_counter() - started, 3)

    page.set_input_files("#files", path)
    row: dict[str, Any] = {"take": passed("#desk:not([hidden])")}
    # What takes no longer than a glance shows no bar.
    row["progress"] = int(page.evaluate("() => document.getElementById('progress').value > 0"))
    row["loop"] = passed(".card[data-state=plays], .card[data-state=judged]")
    row["verdict"] = passed(".card[data-state=judged]")
    return row


def _mended(page: Any) -> float:
    """Return the seconds from a moved cut to the new loop, the middle one of three."""
    found = []
    for _ in range(3):
        page.wait_for_selector("#bar", state="hidden")
        page.wait_for_timeout(1500)
        page.locator(".handle").first.focus()
        # The mark of the old loop's key goes with the change, and comes with the new loop.
        page.evaluate("() => { delete document.body.dataset.remade; }")
        started = time.perf_counter()
        page.keyboard.press("Shift+ArrowRight")
        page.wait_for_selector("body[data-remade]", state="attached")
        found.append(time.perf_counter() - started)
        page.wait_for_selector(".card[data-state=judged]")
    return round(sorted(found)[1], 3)


def _drawn(page: Any) -> float:
    """Return the milliseconds of script a frame, all of the page's callbacks together."""
    page.keyboard.press("3")
    page.evaluate("window.counted = {frames: 0, busy: 0}")
    page.wait_for_timeout(3000)
    counted = page.evaluate("window.counted")
    # Two callbacks a frame: the stage, and the small figures.
    return round(2 * counted["busy"] / max(counted["frames"], 1), 2)


def _pictures(browser: Any, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as kept:
        process, url = _studio(Path(kept))
        try:
            for name, (width, height) in SIZES.items():
                for theme in ("light", "dark"):
                    size = {"width": width, "height": height}
                    page = browser.new_page(viewport=size, color_scheme=theme)
                    page.set_default_timeout(120_000)
                    page.goto(url)
                    page.set_input_files("#files", JUMPS)
                    page.wait_for_selector(".card:nth-child(2)[data-state=judged]")
                    page.wait_for_timeout(1500)
                    page.screenshot(path=folder / f"studio_{name}_{theme}.png", full_page=True)
                    page.close()
        finally:
            process.terminate()
            process.wait()


if __name__ == "__main__":
    main()
