"""Files that are none, or that do not stay as they are, are refused at once."""

from __future__ import annotations

import io
import os
import socket
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.base import files
from roundelay.base.files import content
from roundelay.cli import app

NO_PIPES = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no such pipes")
COMMANDS = [
    ["loop", "{}"],
    ["timeline", "{}"],
    ["inspect", "{}"],
    ["excitations", "{}"],
    ["segment", "{}"],
    ["view", "{}"],
    ["close", "{}", "--frames", "0:10"],
    ["convert", "{}", "out.bvh"],
    ["check", "{}"],
    ["blend", "{}", "{}", "-o", "out.bvh"],
    ["transition", "{}", "{}", "-o", "out.bvh"],
]


@NO_PIPES
@pytest.mark.parametrize("suffix", [".bvh", ".bvh.gz", ".amc", ".glb", ".gltf"])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    os.mkfifo(path)
    (tmp_path / "a.asf").write_text("")
    with pytest.raises(rl.FormatError, match="expected a file, found a named pipe; pipe it into"):
        rl.read(path)


@NO_PIPES
@pytest.mark.parametrize("command", COMMANDS, ids=[command[0] for command in COMMANDS])
def test_every_command_refuses_a_pipe(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("a.bvh")
    result = CliRunner().invoke(app, [one.format("a.bvh") for one in command])
    assert result.exit_code in (1, 2), result.output
    assert "found a named pipe" in result.output


@NO_PIPES
def test_a_library_passes_over_a_pipe(tmp_path):
    os.mkfifo(tmp_path / "a.bvh")
    rl.write(synth.gait("walk", repetitions=1).motion, tmp_path / "b.bvh")
    refused: list[str] = []
    library = rl.build_library(tmp_path, tmp_path / "out", jobs=1, refused=refused.append)
    assert [clip["file"] for clip in library.clips] == ["a.bvh", "b.bvh"]
    assert "named pipe" in refused[0]


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="the system has no such device")
def test_a_device_is_refused(tmp_path):
    link = tmp_path / "a.bvh"
    link.symlink_to("/dev/zero")
    with pytest.raises(rl.FormatError, match="expected a file, found a device"):
        rl.read(link)


@pytest.mark.skipif(not hasattr(socket, "AF_UNIX"), reason="the system has no such sockets")
def test_a_socket_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as one:
        one.bind("a.bvh")
        with pytest.raises(rl.FormatError, match="expected a file, found a socket"):
            rl.read("a.bvh")


@pytest.mark.parametrize("told", [3, 5])
def test_a_file_that_grows_or_shrinks_is_refused(tmp_path, monkeypatch, told):
    path = tmp_path / "a.bvh"
    path.write_bytes(b"four")
    monkeypatch.setattr(os, "fstat", lambda _: os.stat_result([0] * 6 + [told] + [0] * 3))
    with pytest.raises(rl.FormatError, match="found one that changed while it was read"):
        content(path)


def test_what_is_too_large_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "_MOST", 3)
    path = tmp_path / "a.bvh"
    path.write_bytes(b"four")
    with pytest.raises(rl.TooLarge, match="a file of at most"):
        content(path)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"four")))
    with pytest.raises(rl.TooLarge, match="at most"):
        content(Path("-"))
    path.write_bytes(b"one")
    assert content(path) == b"one"
