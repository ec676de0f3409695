"""Programs that play loops: three.js in Chromium, Blender's importers, Godot.

Each takes all files at once and says where every joint is at even times. What is not installed
says so: node modules are looked for in ``build/players``, Blender in ``build/bpy-*``.
"""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["PLAYERS", "Blender", "Godot", "Job", "Played", "Player", "Three"]

Array = NDArray[np.float64]

INSIDE = Path(__file__).resolve().parent / "inside"
BUILD = INSIDE.parent.parent / "build"
# Samples a second of the players that keep time by themselves, and the seconds of the first: at a
# key that ends a round and begins another, rounding would choose between the two.
RATE, START = 240, 1e-4
_ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
_HOST = "http://players.localhost/"


@dataclass(frozen=True)
class Job:
    """A file to play: its rate, its steps from the first frame to the same one period on."""

    file: Path
    fps: float
    frames: int

    @property
    def count(self) -> int:
        """Samples of two rounds, the last of which is the first of a third."""
        return round(2 * self.frames / self.fps * RATE) + 1


@dataclass(frozen=True)
class Played:
    """What a player shows.

    Parameters
    ----------
    names : tuple of str
        Of the joints.
    places : (T, J, 3) ndarray
        In the player's world and unit, two rounds.
    rate : float
        Samples a second.
    duration : float
        Seconds of a round, as the player has it.
    clip : str
        What it calls the animation.
    looped : bool or None
        Whether it repeats by itself; None where a player has no such flag.
    start : float
        Seconds of the first sample.
    """

    names: tuple[str, ...]
    places: Array
    rate: float
    duration: float
    clip: str
    looped: bool | None = None
    start: float = 0.0


class Player(Protocol):
    """A program that plays files of a format in metres, as loops are written for a target."""

    name: str
    suffix: str
    target: str

    def lacks(self) -> str:
        """Say what is not installed; empty if all is."""
        ...

    def play(self, jobs: Sequence[Job], folder: Path) -> list[Played | str]:
        """Play files, or say why one could not be; `folder` is empty and may be used."""
        ...


class Three:
    """three.js in headless Chromium: `AnimationMixer` over two rounds."""

    name, suffix, target = "three.js", "glb", "web"

    def lacks(self) -> str:
        if find_spec("playwright") is None:
            return "needs Playwright: pip install playwright"
        if _chromium() is None:
            return "needs Chromium: apt-get install chromium"
        if not _modules().is_dir():
            return "needs three: npm install --prefix build/players three"
        return ""

    def play(self, jobs: Sequence[Job], folder: Path) -> list[Played | str]:
        from playwright.sync_api import sync_playwright

        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=_chromium(), args=_ARGUMENTS)
            page = browser.new_page()
            page.route(f"{_HOST}**", _served)
            page.goto(f"{_HOST}page.html")
            page.wait_for_selector("body[data-ready]", state="attached")
            return [self._one(page, job) for job in jobs]

    def _one(self, page: Any, job: Job) -> Played | str:
        file = base64.b64encode(job.file.read_bytes()).decode()
        try:
            asked = [file, START, 1.0 / RATE, job.count]
            told = page.evaluate("([f, t, s, n]) => play(f, t, s, n)", asked)
        except Exception as error:  # one file that cannot be played costs itself alone
            return str(error).splitlines()[0]
        numbers = np.frombuffer(base64.b64decode(told["places"]), "<f4").astype(float)
        places = numbers.reshape(job.count, -1, 3)
        names = tuple(told["names"])
        return Played(names, places, RATE, told["duration"], told["clip"], start=START)


def _chromium() -> str | None:
    return shutil.which("chromium") or shutil.which("chromium-browser")


def _modules() -> Path:
    return BUILD / "players" / "node_modules" / "three"


def _served(route: Any) -> None:
    """Answer for a host that is not there with the page and the modules on this machine."""
    path = route.request.url.removeprefix(_HOST)
    if path == "page.html":
        page = (INSIDE / "three.html").read_text()
        route.fulfill(body=page, content_type="text/html")
    elif path.startswith("three/") and (_modules() / path[6:]).is_file():
        text = (_modules() / path[6:]).read_text()
        route.fulfill(body=text, content_type="text/javascript")
    else:
        route.fulfill(status=404, body="")


@dataclass(frozen=True)
class Blender:
    """One of Blender's importers; the poses at every half frame, one round after the other."""

    suffix: str
    target: str
    steps: int = 2

    @property
    def name(self) -> str:
        return f"Blender {self.suffix.upper()}"

    def lacks(self) -> str:
        return "" if _bpy() else "needs bpy: make build/bpy-5.0.1/.ready"

    def play(self, jobs: Sequence[Job], folder: Path) -> list[Played | str]:
        asked = [
            {
                "file": str(job.file),
                "out": str(folder / f"{number}.npz"),
                "fps": job.fps,
                "frames": job.frames - self._left_out,
                "steps": self.steps,
            }
            for number, job in enumerate(jobs)
        ]
        (folder / "jobs.json").write_text(json.dumps(asked))
        _run([str(_bpy()), str(INSIDE / "blender.py"), str(folder / "jobs.json")], folder)
        return [self._one(Path(one["out"]), job) for one, job in zip(asked, jobs, strict=True)]

    @property
    def _left_out(self) -> int:
        """How many steps a file lacks that holds frames, not keys at times."""
        return 1 if self.suffix == "bvh" else 0

    def _one(self, file: Path, job: Job) -> Played | str:
        if not file.exists():
            return "Blender died"
        with np.load(file) as found:
            if "error" in found:
                return str(found["error"])
            once, names = found["places"].astype(float), tuple(map(str, found["names"]))
            duration, clip = float(found["duration"]), str(found["clip"])
        if self._left_out:
            # A scene's range is played frame by frame: after the last, the first.
            once = once[:: self.steps]
            around = np.concatenate([once, once, once[:1]])
            return Played(names, around, job.fps, duration + 1.0 / job.fps, clip)
        around = np.concatenate([once[:-1], once[:-1], once[:1]])
        return Played(names, around, job.fps * self.steps, duration, clip)


def _bpy() -> Path | None:
    ready = sorted(BUILD.glob("bpy-*/.ready"))
    return ready[-1].parent / "bin" / "python" if ready else None


class Godot:
    """Godot 3.2: its importer at the file's rate, not optimised, and `AnimationPlayer`."""

    name, suffix, target = "Godot", "glb", "godot"

    def lacks(self) -> str:
        return "" if shutil.which("godot3-server") else "needs Godot: apt-get install godot3-server"

    def play(self, jobs: Sequence[Job], folder: Path) -> list[Played | str]:
        (folder / "project.godot").write_text("config_version=4\n")
        shutil.copy(INSIDE / "godot.gd", folder / "play.gd")
        asked = [self._asked(job, number, folder) for number, job in enumerate(jobs)]
        (folder / "jobs.json").write_text(json.dumps(asked))
        _run(["godot3-server", "--path", str(folder), "-e", "-q"], folder)
        _run(["godot3-server", "--path", str(folder), "-s", "play.gd"], folder)
        return [self._one(Path(one["out"]), job) for one, job in zip(asked, jobs, strict=True)]

    def _asked(self, job: Job, number: int, folder: Path) -> dict[str, Any]:
        scene = f"job{number}.glb"
        shutil.copy(job.file, folder / scene)
        # By default Godot 3 samples 15 times a second and leaves out keys.
        settings = f"animation/fps={job.fps:g}\nanimation/optimizer/enabled=false\n"
        head = '[remap]\nimporter="scene"\ntype="PackedScene"\n\n[params]\n'
        (folder / f"{scene}.import").write_text(head + settings)
        out = str(folder / f"out{number}")
        every = {"start": START, "seconds": 1.0 / RATE, "count": job.count}
        return {"scene": scene, "out": out, **every}

    def _one(self, out: Path, job: Job) -> Played | str:
        told, numbers = out.with_suffix(".json"), out.with_suffix(".f32")
        if not told.exists():
            return "Godot could not play it"
        found = json.loads(told.read_text())
        places = np.fromfile(numbers, "<f4").astype(float).reshape(job.count, -1, 3)
        names, looped = tuple(found["names"]), bool(found["looped"])
        return Played(names, places, RATE, found["duration"], found["clip"], looped, START)


def _run(words: list[str], folder: Path) -> None:
    with (folder / "log.txt").open("ab") as log:
        subprocess.run(words, stdout=log, stderr=log, check=False, timeout=1800)


PLAYERS: tuple[Player, ...] = (
    Three(),
    Blender("glb", "blender"),
    Blender("fbx", "unreal"),
    Blender("bvh", "blender"),
    Godot(),
)
