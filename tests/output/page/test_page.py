"""The page as text: size, sampling, names, what it may ask for."""

from __future__ import annotations

import re

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.output.figures.space import Space, bones
from roundelay.output.page import build_page
from roundelay.output.page.bundle import bundle, bundled_script
from roundelay.output.page.capture import sampling_step

from .unpack import unpacked, values


def payload(page: str) -> str:
    return re.search(r'id="payload">([^<]*)<', page)[1]


def test_a_capture_of_3000_frames_is_less_than_a_megabyte():
    made = synth.gait("walk", repetitions=91.0, fps=30.0)
    assert len(made.motion) >= 3000
    assert len(build_page(made.motion, rl.make_loops(made.motion))) < 1_000_000


def test_the_bundled_captures_are_small(jumps, jump_loops):
    assert len(build_page(jumps, jump_loops)) < 500_000


def test_positions_come_back_to_a_thousandth_of_the_body(jumps, jump_loops):
    found, data = unpacked(payload(build_page(jumps, jump_loops)))
    capture = found["capture"]
    space = Space.of(jumps)
    assert (capture["frames"], capture["step"], capture["joints"]) == (2752, 4, 31)
    expected = space.points(jumps)[::4].reshape(688, -1)
    assert np.allclose(values(capture["points"], data), expected, atol=1e-3)


def test_the_floor_is_at_zero_and_up_is_y():
    made = synth.gait("walk").motion
    points = Space.of(made).points(made)
    assert points[..., 1].min() == pytest.approx(0.0, abs=0.06)
    assert 0.6 < points[..., 1].max() < 1.2


def test_other_axes_may_point_up():
    from dataclasses import replace

    made = synth.gait("walk").motion
    sideways = replace(made, up=2)
    points, places = Space.of(sideways).points(sideways), sideways.positions()
    joints = made.skeleton.n_joints
    apart = np.linalg.norm(places[:, 3] - places[:, 5], axis=-1) / made.skeleton.size
    assert np.allclose(np.linalg.norm(points[:, 3] - points[:, 5], axis=-1), apart)
    floor = Space.of(sideways).floor
    assert np.allclose(points[:, :joints, 1] * made.skeleton.size + floor, places[..., 2])


@pytest.mark.parametrize(
    ("fps", "frames", "step"),
    [(30, 3000, 1), (120, 3000, 4), (100, 3000, 3), (24, 100, 1), (120, 120_000, 12), (8, 9000, 1)],
)
def test_sampling(fps, frames, step):
    made = synth.gait("walk", repetitions=1.0).motion
    long = rl.Motion(
        made.skeleton, np.tile(made.rotations[:1], (frames, 1, 1)), np.zeros((frames, 3)), 1 / fps
    )
    assert sampling_step(long) == step


def test_bones_have_sides(jumps):
    names = jumps.skeleton.names
    joints = [bone for bone in bones(jumps.skeleton) if bone.stop < len(names)]
    sides = {names[bone.stop]: bone.side for bone in joints}
    assert sides["LeftFoot"] == -1
    assert sides["RightFoot"] == 1
    assert sides["Head"] == 0


def test_names_are_text_not_markup():
    page = bundle("<b>&</b>", "payload")
    assert "<title>&lt;b&gt;&amp;&lt;/b&gt; · roundelay</title>" in page


def test_the_page_names_no_address(jumps, jump_loops):
    page = build_page(jumps, jump_loops).replace("http://www.w3.org/2000/svg", "")
    assert not re.search(r"https?://|\bsrc=|@import|url\(", page)
    assert "default-src 'none'" in page


def test_every_module_is_bundled_once():
    from importlib.resources import files

    script = bundled_script()
    for module in files("roundelay.output.page").joinpath("modules").iterdir():
        assert script.count(f"const module_{module.name.removesuffix('.js')} =") == 1
    assert not re.search(r"^(import|export) ", script, re.MULTILINE)


def test_the_page_tells_the_verdict(jumps, jump_loops):
    found, _ = unpacked(payload(build_page(jumps, jump_loops)))
    assert [motion["verdict"] for motion in found["motions"]] == [
        str(x.verdict) for x in jump_loops
    ]


def test_a_capture_that_is_too_poor_for_evidence():
    made = synth.wander(2.0).motion
    page = build_page(made, refusal=rl.NoPeriod("no periodic motion found: nothing comes back"))
    found, _ = unpacked(payload(page))
    assert found["motions"] == []
    assert "nothing comes back" in found["reason"]


def test_behaviours_are_on_the_timeline(jumps, jump_loops):
    cut = rl.segment(jumps, n_segments=3)
    found, _ = unpacked(payload(build_page(jumps, jump_loops, segmentation=cut)))
    assert found["segments"] == [[part.start, part.stop, part.label] for part in cut.segments]


def test_feet_stand_now_and_then(jumps, jump_loops):
    found, _ = unpacked(payload(build_page(jumps, jump_loops)))
    names = jumps.skeleton.names
    for feet, whole in ((found["capture"]["feet"], 2752), (found["motions"][0]["loop"]["feet"], 1)):
        assert {names[foot["joint"]][:4] for foot in feet} == {"Left", "Righ"}
        for foot in feet:
            # A loop's spans may begin before the period and end after it.
            standing = sum(min(stop, whole) - max(start, 0) for start, stop in foot["spans"])
            assert 0.2 * whole < standing < 0.95 * whole
