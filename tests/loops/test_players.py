"""Loops as three.js plays them: where they are joined, nothing is to be seen."""

from __future__ import annotations

import pytest
from benchmarks._players import Three
from benchmarks.players import JOIN, SLIP, STEP, measured, mixed, piece_of, summary

from roundelay import synth

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def figures(tmp_path_factory, jumps) -> dict:
    player = Three()
    if lack := player.lacks():
        pytest.skip(lack)
    made = {
        "walk": synth.gait("walk").motion,
        "turn": synth.gait("walk", turning=0.4).motion,
        "run": synth.gait("run").motion,
        "punch": synth.gait("punch").motion,
        "spin": synth.gait("spin").motion,
        "jump": jumps,
    }
    loops = [piece_of(motion, name, "test") for name, motion in made.items()]
    pieces = [*loops, *mixed(loops)]
    told = summary(measured(player, pieces, tmp_path_factory.mktemp("played"), every_rate=True))
    return {name: of.get(player.name) for name, of in told.items()}


def test_all_files_are_played(figures):
    assert figures["played"] >= 4 * 6
    assert figures["failed"] == 0


def test_nothing_jerks_where_a_loop_is_joined(figures):
    assert figures["join"] <= JOIN


def test_steps_are_as_large_as_in_the_capture(figures):
    # But for the mean of ten unlike jumps; what was written is all there.
    assert figures["step_under"] <= 0.17
    assert figures["step_typical"] >= STEP
    assert figures["kept"] >= 0.99


def test_joints_and_travel_are_as_written(figures):
    assert figures["apart"] <= SLIP
    assert figures["travel"] <= SLIP
    assert figures["seconds"] < 1e-4
