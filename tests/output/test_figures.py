"""Figures: each is drawn from its result, and written in every format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import roundelay as rl
import roundelay.output.figures as figures
from roundelay import synth
from roundelay.motion.features import point_cloud
from roundelay.output.figures.palette import phase_colours
from roundelay.segmentation import segment
from roundelay.timeline.proposals.excitation import Excitations, excitations
from roundelay.topology import persistent_cohomology


@pytest.fixture(scope="module")
def walk() -> rl.Motion:
    return synth.gait("walk", repetitions=4.0, seed=1).motion


@pytest.fixture(scope="module")
def cycle(walk) -> rl.Cycle:
    return rl.find_cycles(walk)[0]


def painted(figure) -> float:
    """The share of the picture that is not white."""
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    return float(np.mean(np.any(pixels < 250, axis=-1)))


AXES = {
    "barcode": lambda axes, cycle, walk: figures.barcode(cycle.evidence.barcode, axes=axes),
    "coordinate": lambda axes, cycle, walk: figures.coordinate(cycle.evidence, walk, axes=axes),
    "plane": lambda axes, cycle, walk: figures.plane(cycle, walk, axes=axes),
    "density": lambda axes, cycle, walk: figures.density(cycle.evidence, axes=axes),
    "circle": lambda axes, cycle, walk: figures.circle_density(cycle.evidence, axes=axes),
    "period line": lambda axes, cycle, walk: figures.period_line(cycle.evidence, walk, axes=axes),
    "trajectory": lambda axes, cycle, walk: figures.typical_trajectory(cycle, walk, axes=axes),
    "diagram": lambda axes, cycle, walk: figures.persistence_diagram(
        cycle.evidence.barcode, axes=axes
    ),
    "curve": lambda axes, cycle, walk: figures.method_curve(segment(walk), axes=axes),
    "behaviours": lambda axes, cycle, walk: figures.behaviours(segment(walk), axes=axes),
}


@pytest.mark.parametrize("name", AXES)
def test_drawn_into_axes(name, cycle, walk):
    figure = figures.new_figure(5.0, 4.0)
    axes = figure.add_subplot(projection="polar" if name == "circle" else None)
    assert AXES[name](axes, cycle, walk) is axes
    assert painted(figure) > 0.01


@pytest.mark.parametrize("name", AXES)
def test_drawn_on_axes_of_their_own(name, cycle, walk):
    axes = AXES[name](None, cycle, walk)
    assert axes.name == ("polar" if name == "circle" else "rectilinear")
    assert painted(axes.figure) > 0.01


def test_bars_that_never_end_are_drawn_to_the_largest_scale():
    round_and_round = np.exp(2j * np.pi * np.arange(40) / 40)
    points = np.column_stack((round_and_round.real, round_and_round.imag))
    bars = persistent_cohomology(points, max_scale=0.8)
    assert np.isinf(bars.deaths[0])
    assert figures.barcode(bars, unit="m").lines[0].get_xdata()[1] == pytest.approx(0.8)
    assert figures.persistence_diagram(bars, unit="m").get_ylim()[1] == pytest.approx(0.84)


WHOLE = {
    "overview": lambda cycle, walk: figures.overview(walk, [cycle]),
    "remaps": lambda cycle, walk: figures.remaps(walk, cycle.evidence),
    "angles": lambda cycle, walk: figures.angles(walk, cycle),
    "strip": lambda cycle, walk: figures.strip(cycle.sample()),
    "timeline": lambda cycle, walk: figures.timeline(segment(walk)),
    "excitations": lambda cycle, walk: figures.excitations(
        walk, excitations(point_cloud(walk), walk.fps)
    ),
}


@pytest.mark.parametrize("name", WHOLE)
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_saved(name, suffix, cycle, walk, tmp_path):
    path: Path = tmp_path / f"figure.{suffix}"
    figures.save(WHOLE[name](cycle, walk), path)
    start = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix]
    assert path.read_bytes().startswith(start)
    assert list(tmp_path.iterdir()) == [path]


def test_excitations_have_a_row_a_class(walk, cycle):
    found = excitations(point_cloud(walk), walk.fps, classes=3)
    bars, *rows = figures.excitations(walk, found).axes
    assert len(rows) == 3
    coloured = {line.get_color() for line in bars.lines}
    assert len(coloured) == 1 + 3
    none = figures.excitations(walk, Excitations(found.barcode, ()))
    assert none.axes[1].get_title(loc="left") == "no class stands out from noise"


def test_the_density_is_one(cycle):
    figure = figures.new_figure(4.0, 4.0)
    axes = figure.subplots()
    figures.density(cycle.evidence, axes=axes)
    x, y = axes.lines[0].get_data()
    assert np.mean(y) * (x[-1] - x[0]) == pytest.approx(1.0, abs=0.05)


def test_angles_of_capture_and_loop_agree(cycle, walk):
    axes = figures.angles(walk, cycle, joints=["LeftUpLeg"], periods=2).axes
    capture, loop = (axes[place].lines[0].get_ydata() for place in (0, 2))
    assert np.allclose(capture, loop, atol=0.1 * np.ptp(capture))


def test_angles_need_evidence(cycle, walk):
    from dataclasses import replace

    with pytest.raises(ValueError, match="evidence"):
        figures.angles(walk, replace(cycle, evidence=None))
    with pytest.raises(rl.SkeletonMismatch):
        figures.angles(walk, cycle, joints=["tail"])


@pytest.mark.parametrize("suffix", ["gif", "png"])
def test_a_moving_picture(cycle, suffix, tmp_path):
    from PIL import Image

    path = tmp_path / f"loop.{suffix}"
    figures.animation(cycle.sample(), path, fps=10.0, size=120)
    with Image.open(path) as picture:
        assert picture.n_frames == round(10 * cycle.period)
        assert picture.height == 120
        assert picture.info["loop"] == 0


def test_moving_pictures_are_gif_or_png(cycle, tmp_path):
    with pytest.raises(ValueError, match="gif"):
        figures.animation(cycle.sample(), tmp_path / "loop.mp4")


def test_phase_colours_go_around():
    colours = phase_colours(64)
    assert len(set(colours)) == 64
    channels = np.array(
        [[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in [*colours, colours[0]]]
    )
    assert np.abs(np.diff(channels, axis=0)).max() < 45


def test_nothing_draws_on_import():
    import subprocess
    import sys

    code = "import sys, roundelay.output.figures; print('matplotlib' in sys.modules)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "False"


def test_the_loop_command_writes_moving_pictures(walk, tmp_path):
    from typer.testing import CliRunner

    from roundelay.cli import app

    rl.write(walk, tmp_path / "walk.bvh")
    asked = ["loop", str(tmp_path / "walk.bvh"), "-o", str(tmp_path), "--gif", "--no-picture"]
    assert CliRunner().invoke(app, asked).exit_code == 0
    assert (tmp_path / "walk_loop.gif").read_bytes().startswith(b"GIF89a")
