"""A studio that runs, and a browser that looks at it."""

from __future__ import annotations

import http.client
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from tests.chromium import Seen, visits

import roundelay as rl
from roundelay import synth
from roundelay.studio.work import checksum


@dataclass
class Running:
    """A studio in a process of its own."""

    url: str
    folder: Path
    process: subprocess.Popen[str]

    @property
    def port(self) -> int:
        return urlsplit(self.url).port or 0

    def ask(
        self, path: str, method: str = "GET", body: bytes | str | None = None, **headers: str
    ) -> tuple[int, str]:
        """Ask for what lies under the token, and return the status and the answer."""
        whole = path if path.startswith("/") else f"{urlsplit(self.url).path}{path}"
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            line.request(method, whole, body, {"Host": f"127.0.0.1:{self.port}"} | headers)
            answer = line.getresponse()
            return answer.status, answer.read().decode("utf-8", "surrogateescape")
        finally:
            line.close()

    def fetched(self, path: str) -> bytes:
        status, text = self.ask(path)
        assert status == 200, text
        return text.encode("utf-8", "surrogateescape")

    def events(self, path: str, body: Any) -> list[dict[str, Any]]:
        status, text = self.ask(path, "POST", json.dumps(body))
        assert status == 200, text
        return [json.loads(line) for line in text.splitlines()]

    def fault(self, *question: Any, **headers: str) -> tuple[int, str]:
        status, text = self.ask(*question, **headers)
        return status, json.loads(text)["error"]


@pytest.fixture(scope="session")
def one_studio(tmp_path_factory) -> Iterator[Running]:
    pytest.importorskip("starlette", reason="needs the extra studio")
    pytest.importorskip("uvicorn", reason="needs the extra studio")
    with running(tmp_path_factory.mktemp("studio") / "kept") as made:
        yield made


@pytest.fixture
def studio(one_studio) -> Running:
    """With an empty folder."""
    for path in one_studio.folder.iterdir():
        path.unlink()
    return one_studio


@contextmanager
def running(folder: Path, *words: str) -> Iterator[Running]:
    """Start a studio, and end it."""
    command = [sys.executable, "-m", "roundelay", "studio", str(folder), "--no-browser", *words]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        yield Running(process.stdout.readline().split()[-1], folder, process)
    finally:
        process.terminate()
        rest = process.communicate(timeout=30)[0]
    assert "Traceback" not in rest, rest


@pytest.fixture(scope="session")
def walk() -> rl.Motion:
    """Four strides."""
    return synth.gait("walk", repetitions=4.2, fps=60.0).motion


@pytest.fixture
def walk_file(walk, tmp_path) -> Path:
    path = tmp_path / "walk.bvh"
    rl.write(walk, path)
    return path


@pytest.fixture(scope="session")
def two_file(tmp_path_factory) -> Path:
    """Strides, then punches."""
    parts = [
        synth.gait("walk", repetitions=5, fps=60.0),
        synth.gait("punch", repetitions=6, fps=60.0),
    ]
    path = tmp_path_factory.mktemp("two") / "two.bvh"
    rl.write(synth.sequence(*parts).motion, path)
    return path


@pytest.fixture
def work_of() -> Callable[..., rl.Work]:
    def made(path: Path, *parts: rl.Part, **options: Any) -> rl.Work:
        return rl.Work(
            path.name,
            checksum(path),
            len(rl.read(path)),
            parts,
            rl.LoopOptions(**options),
            path.parent,
        )

    return made


@pytest.fixture
def visit(chromium, studio) -> Iterator[Callable[..., Seen]]:
    """Open the studio; it must complain of nothing and ask nobody else."""
    own = (studio.url, "data:", f"blob:{studio.url.rsplit('/', 2)[0]}")
    with visits(chromium, own) as visited:
        yield lambda **how: visited(studio.url, **{"height": 860, **how})
