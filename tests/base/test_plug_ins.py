"""Registries: names, what is lacking, and plug-ins that fail."""

from __future__ import annotations

from typing import Protocol

import pytest

from plugins import install, python, roundelay
from roundelay.base.registry import Registry
from roundelay.formats import readers, suffixes_of

READER = """
class Reader:
    name, suffixes = "mine", (".mine",)
    def read(self, path):
        return None
"""


class Teller(Protocol):
    name: str

    def tell(self) -> str: ...


class Plain:
    def __init__(self, name: str = "plain") -> None:
        self.name = name

    def tell(self) -> str:
        return self.name


@pytest.fixture
def tellers() -> Registry[Teller]:
    registry: Registry[Teller] = Registry("teller", "roundelay.none", Teller)
    registry.add(Plain("first"))
    registry.add(Plain("second"))
    return registry


def test_found_by_name_in_order(tellers):
    assert tellers.names() == ("first", "second")
    assert tellers["second"].tell() == "second"
    with pytest.raises(ValueError, match=r"expected a teller among \('first', 'second'\), found"):
        tellers["third"]


def test_a_taken_name_is_refused(tellers):
    with pytest.raises(ValueError, match="expected a new name for a teller, found 'first'"):
        tellers.add(Plain("first"))
    tellers.remove("first")
    tellers.add(Plain("first"))
    assert tellers.names() == ("second", "first")


def test_what_lacks_a_part_is_refused_with_what_it_lacks(tellers):
    class Mute:
        name = "mute"

    with pytest.raises(TypeError, match="expected a teller with tell, found"):
        tellers.add(Mute())
    with pytest.raises(TypeError, match="expected a teller with name, tell, found 3"):
        tellers.add(3)
    with pytest.raises(TypeError, match="expected text as the name of a teller, found 3"):
        tellers.add(Plain(3))


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("import nothing_of_this_name", "No module named 'nothing_of_this_name'"),
        ("raise SystemExit('no licence')", "no licence"),
        (READER.replace("read(self", "look(self"), "expected a reader with read, found"),
        (READER.replace('"mine", ', '"bvh", '), "expected a new name for a reader, found 'bvh'"),
        (READER.replace("Reader", "Other"), "has no attribute 'Reader'"),
    ],
)
def test_a_broken_plug_in_costs_a_warning_that_names_it(tmp_path, text, fault):
    points = {"broken": "broken:Reader", "sound": "sound:Reader"}
    files = {"broken.py": text, "sound.py": READER.replace('"mine", ', '"sound", ')}
    install(tmp_path, files, {"roundelay.readers": points})
    code = "from roundelay.formats import readers; print(readers.names(), readers.names())"
    shown = python(tmp_path, "-c", code)
    known = (*readers.names(), "sound")
    assert shown.stdout == f"{known} {known}\n"
    assert shown.stderr.count("RoundelayWarning") == 1
    assert "a plug-in cannot be used: reader 'broken' of broken:Reader: " in shown.stderr
    assert fault in shown.stderr


def test_a_broken_plug_in_costs_the_command_line_one_line(tmp_path):
    install(tmp_path, {"broken.py": "1 / 0"}, {"roundelay.readers": {"broken": "broken:Reader"}})
    shown = roundelay(tmp_path, "convert walk.xyz walk.bvh")
    assert shown.returncode == 2
    note, refusal = shown.stderr.splitlines()
    assert note == (
        "roundelay: note: a plug-in cannot be used: reader 'broken' of broken:Reader: "
        "division by zero"
    )
    known = ", ".join(suffixes_of(readers))
    assert refusal.endswith(f"expected a file of type {known}, found 'walk.xyz'")


def test_entry_points_are_looked_up_only_for_what_is_not_ours(tmp_path):
    code = """
import sys
import roundelay as rl
from roundelay import synth
motion = synth.gait("walk").motion
rl.write(motion, "walk.bvh")
rl.find_cycles(rl.read("walk.bvh"), rl.Options(method="centroid", proposers=("recurrence",)))
told = rl.understand(motion, rl.Options(proposers=("recurrence",)))
rl.segment(motion, method="pca", timeline=told)
print("importlib.metadata" in sys.modules)
"""
    assert python(tmp_path, "-c", code).stdout == "False\n"
