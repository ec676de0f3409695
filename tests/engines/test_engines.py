"""The importer scripts for engines: one compiled and one run against what they use of them."""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from roundelay import synth
from roundelay.loops.options import LoopOptions
from roundelay.loops.profiles import profiles
from roundelay.pipeline import find_cycles

ROOT = Path(__file__).parents[2]
UNITY = ROOT / "engines" / "unity" / "RoundelayImporter.cs"
UNREAL = ROOT / "engines" / "unreal" / "roundelay_import.py"


@pytest.fixture(scope="module")
def cycle():
    return find_cycles(synth.gait("walk", turning=0.3).motion)[0]


def playback(cycle, target, **given):
    return profiles["generic"].record(cycle, LoopOptions(target=target, **given))


def test_the_importer_for_unity_compiles(tmp_path):
    compiler = shutil.which("mcs")
    if compiler is None:
        pytest.skip("needs a C# compiler: apt-get install mono-mcs")
    stubs = Path(__file__).with_name("unity_stubs.cs")
    words = [compiler, "-target:library", "-warnaserror", "-nowarn:0649"]
    done = subprocess.run(
        [*words, f"-out:{tmp_path / 'made.dll'}", str(UNITY), str(stubs)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_importer_for_unity_sets_events_in_every_period(cycle, tmp_path):
    compiler, runner = shutil.which("mcs"), shutil.which("mono")
    if compiler is None or runner is None:
        pytest.skip("needs a C# compiler and mono: apt-get install mono-mcs")
    told = playback(cycle, "unity", periods=3)
    count, frames = told["frames_per_period"], told["frames"]
    sources = [Path(__file__).with_name(name) for name in ("unity_stubs.cs", "unity_run.cs")]
    made = str(tmp_path / "made.exe")
    words = ["-nowarn:0649", f"-out:{made}"]
    subprocess.run([compiler, *words, str(UNITY), *map(str, sources)], check=True)
    events = [word for event in told["events"] for word in (event["name"], str(event["phase"]))]
    shown = subprocess.run(
        [runner, made, str(frames), str(count), *events],
        capture_output=True,
        text=True,
        check=True,
    )
    lines = [line.rsplit(" ", 1) for line in shown.stdout.splitlines()]
    wanted = [
        (event["name"], (event["frame"] + k * count) / frames)
        for k in range(3)
        for event in told["events"]
    ]
    assert frames == 3 * count
    assert [name for name, _ in lines] == [name for name, _ in wanted]
    times = [float(time) for _, time in lines]
    assert times == pytest.approx([time for _, time in wanted], abs=1e-5)


def test_the_importer_for_unity_reads_names_of_the_record(cycle):
    told = playback(cycle, "unity")
    classes = re.findall(r"public class (\w+)\s*\{(.*?)\n    \}", UNITY.read_text(), re.DOTALL)
    fields = {name: re.findall(r"public [\w\[\]]+ (\w+);", body) for name, body in classes}
    assert set(fields["Playback"]) <= set(told)
    assert set(fields["RootMotion"]) <= set(told["root_motion"])
    assert set(fields["Event"]) <= set(told["events"][0])


class Object:
    """Anything of the editor that has properties."""

    def __init__(self) -> None:
        self.known = {}

    def set_editor_property(self, name, value):
        self.known[name] = value

    def get_editor_property(self, name):
        return self.known[name]


class AnimSequence(Object):
    """A sequence that keeps what is set."""

    def __init__(self, path) -> None:
        super().__init__()
        self.path, self.moves, self.tracks, self.saved = path, None, {}, False


class Library:
    """What is used of AnimationLibrary."""

    def set_root_motion_enabled(self, sequence, enabled):
        sequence.moves = enabled

    def set_root_motion_lock_type(self, sequence, kind):
        sequence.lock = kind

    def is_valid_anim_notify_track_name(self, sequence, track):
        return track in sequence.tracks

    def remove_animation_notify_track(self, sequence, track):
        del sequence.tracks[track]

    def add_animation_notify_track(self, sequence, track):
        assert track not in sequence.tracks
        sequence.tracks[track] = []

    def add_animation_sync_marker(self, sequence, name, seconds, track):
        sequence.tracks[track].append((name, seconds))


@pytest.fixture
def importer(monkeypatch):
    def saved(sequence):
        sequence.saved = True

    def run(tasks):
        for task in tasks:
            name = Path(task.known["filename"]).stem
            assert task.known["automated"]
            task.known["imported_object_paths"] = [f"{task.known['destination_path']}/{name}", "m"]

    stub = SimpleNamespace(
        AnimSequence=AnimSequence,
        AnimationLibrary=Library(),
        AssetImportTask=Object,
        AssetToolsHelpers=SimpleNamespace(
            get_asset_tools=lambda: SimpleNamespace(import_asset_tasks=run)
        ),
        EditorAssetLibrary=SimpleNamespace(
            load_asset=lambda path: AnimSequence(path) if path != "m" else Object(),
            save_loaded_asset=saved,
        ),
        FBXImportType=SimpleNamespace(FBXIT_SKELETAL_MESH=1),
        FbxImportUI=Object,
        RootMotionRootLock=SimpleNamespace(ANIM_FIRST_FRAME=1),
    )
    monkeypatch.setitem(sys.modules, "unreal", stub)
    found = importlib.util.spec_from_file_location("roundelay_import", UNREAL)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_the_importer_for_unreal_marks_every_period(importer, cycle):
    told = playback(cycle, "unreal", periods=3)
    sequence = AnimSequence("walk")
    importer.set_up(sequence, told)
    times = [seconds for _, seconds in sequence.tracks["roundelay"]]
    period = told["frames_per_period"] / told["fps"]
    once = [event["seconds"] for event in told["events"]]
    assert times == pytest.approx([k * period + time for k in range(3) for time in once])
    assert times == sorted(times)


@pytest.mark.parametrize("in_place", [False, True])
def test_the_importer_for_unreal_sets_root_motion_and_events(importer, cycle, tmp_path, in_place):
    told = playback(cycle, "unreal", in_place=in_place)
    record = tmp_path / "Walk_loop.json"
    record.write_text(json.dumps({"cycles": [{"files": ["Walk_loop.fbx"], "playback": told}]}))
    (sequence,) = importer.import_loops(str(record), "/Game/Loops")
    assert sequence.path == "/Game/Loops/Walk_loop"
    assert sequence.moves is not in_place
    expected = [(event["name"], event["seconds"]) for event in told["events"]]
    assert sequence.tracks["roundelay"] == expected
    importer.set_up(sequence, told)
    assert sequence.tracks["roundelay"] == expected
    assert sequence.saved
