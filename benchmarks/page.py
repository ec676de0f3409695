"""The page in headless Chromium: its size, its load time, its frames a second.

Usage: python -m benchmarks.page [--seconds 3] [--json] [--keep] [CAPTURE ...]

By default the bundled captures and a made one of 3000 frames at 30 a second, whose every frame
is in the page. Frames a second are counted while the page plays at 1366 x 820, in each of its
views and with onion skin; the browser gives at most 60. Drawing is the mean time of one frame's
script, without the browser's own painting. Needs ``pip install playwright`` and Debian's
``chromium``.
"""

from __future__ import annotations

import shutil
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks._harness import Target, parser, report
from roundelay import synth
from roundelay.output.page import build_page

BUNDLED = sorted(Path(__file__).parent.parent.glob("data/captures/*.bvh"))
TARGETS = (
    Target("slowest", ">=", 30, "frames a second in the slowest view"),
    Target("load_ms", "<=", 1000, "milliseconds until the page is ready"),
    Target("kilobytes", "<=", 300, "kB of the largest page"),
)
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
# Counts frames, and times the callbacks that the page asks to run in them.
COUNTER = """
const ask = window.requestAnimationFrame.bind(window);
window.counted = {frames: 0, busy: 0};
window.requestAnimationFrame = (work) => ask((now) => {
  const start = performance.now();
  work(now);
  window.counted.busy += performance.now() - start;
  window.counted.frames += 1;
});
"""


def main() -> None:
    options = parser(__doc__, data=None)
    options.add_argument("captures", nargs="*", type=Path)
    options.add_argument("--seconds", type=float, default=3.0, help="played in each view")
    arguments = options.parse_args()
    motions = [_read(path) for path in arguments.captures or BUNDLED]
    if not arguments.captures:
        motions.append(synth.gait("walk", repetitions=91.0, fps=30.0).motion)
    rows = _measured(motions, arguments.seconds)
    summary = {
        "slowest": min(min(row["fps"].values()) for row in rows),
        "load_ms": max(row["load_ms"] for row in rows),
        "kilobytes": max(row["kilobytes"] for row in rows),
        "captures": {row["capture"]: row for row in rows},
    }
    report("page", {"summary": summary}, TARGETS, arguments, table=map(_line, rows))


def _line(row: dict[str, Any]) -> str:
    views = ", ".join(f"{name} {fps:.0f}" for name, fps in row["fps"].items())
    return (
        f"{row['capture']}: {row['frames']} frames, {row['joints']} joints; built in "
        f"{row['build_seconds']:.2f} s, {row['kilobytes']:.0f} kB, ready after "
        f"{row['load_ms']:.0f} ms; frames a second: {views}; drawing {row['draw_ms']:.1f} ms"
    )


def _read(path: Path) -> rl.Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return rl.read(path)


def _built(motion: rl.Motion) -> str:
    try:
        return build_page(motion, rl.make_loops(motion))
    except rl.NoPeriod as refusal:
        return build_page(motion, refusal=refusal)


def _measured(motions: list[rl.Motion], seconds: float) -> list[dict[str, Any]]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        program = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        return [_row(motion, browser, Path(folder) / "page.html", seconds) for motion in motions]


def _row(motion: rl.Motion, browser: Any, path: Path, seconds: float) -> dict[str, Any]:
    started = time.perf_counter()
    text = _built(motion)
    built = time.perf_counter() - started
    path.write_text(text, encoding="utf-8")
    page = browser.new_page(viewport={"width": 1366, "height": 820})
    page.add_init_script(COUNTER)
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready]")
    ready = page.evaluate("Number(document.body.dataset.ready)")
    page.click("#play")
    views = ["capture"]
    if page.is_visible("#views"):
        views += ["loop", "beside", "overlay"]
    fps, busy = {}, []
    for number, view in enumerate(views, 1):
        page.keyboard.press(str(number))
        fps[view], drawing = _played(page, seconds)
        busy.append(drawing)
    page.keyboard.press("o")
    fps["onion skin"], _ = _played(page, seconds)
    page.close()
    return {
        "capture": motion.name,
        "frames": len(motion),
        "joints": motion.skeleton.n_joints,
        "build_seconds": round(built, 3),
        "kilobytes": round(len(text.encode()) / 1e3, 1),
        "load_ms": round(ready, 1),
        "fps": fps,
        "draw_ms": round(max(busy), 2),
    }


def _played(page: Any, seconds: float) -> tuple[float, float]:
    """Return frames a second and milliseconds of script a frame."""
    page.evaluate("window.counted = {frames: 0, busy: 0}")
    started = time.perf_counter()
    page.wait_for_timeout(1000 * seconds)
    counted = page.evaluate("window.counted")
    passed = time.perf_counter() - started
    return round(counted["frames"] / passed, 1), counted["busy"] / max(counted["frames"], 1)


if __name__ == "__main__":
    main()
