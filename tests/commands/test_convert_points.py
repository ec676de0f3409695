"""Points become skeletons with turning bones where a format of skeletons is written."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks._marker_takes import markers, standing_walk
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.motion.floating import motion_of_points
from roundelay.motion.points import Points

runner = CliRunner()


@pytest.fixture(scope="module")
def walk():
    motion, _ = standing_walk(strides=2, fps=30)
    return motion


@pytest.fixture
def trc(walk, tmp_path):
    return written(*markers(walk), tmp_path / "walk.trc")


def written(names, places, path):
    rl.write(motion_of_points(Points(names, 1000 * places, 30.0, units="mm")), path)
    return path


def test_markers_become_bones(walk, trc, tmp_path):
    target = tmp_path / "walk.bvh"
    result = runner.invoke(app, ["convert", str(trc), str(target)])
    assert result.exit_code == 0, result.output
    assert f"{len(walk)} frames at 30 fps" in " ".join(result.output.split())
    motion = rl.read(target)
    assert {"Hips", "Spine", "LeftUpLeg", "RightForeArm", "Head"} <= set(motion.skeleton.names)
    assert motion.translations is None
    knee = motion.positions()[:, motion.skeleton.index("LeftLeg")]
    true = 1000 * walk.positions()[:, walk.skeleton.index("LeftLeg")]
    assert np.linalg.norm(knee - true, axis=1).max() < 25.0


def test_points_are_written_as_they_are_where_asked_to(trc, tmp_path):
    target = tmp_path / "walk.bvh"
    assert runner.invoke(app, ["convert", str(trc), str(target), "--points"]).exit_code == 0
    assert "LKNE" in rl.read(target).skeleton.names


def test_formats_of_points_get_points(trc, tmp_path):
    target = tmp_path / "walk.c3d"
    assert runner.invoke(app, ["convert", str(trc), str(target)]).exit_code == 0
    assert "LKNE" in rl.read_points(target).names


def test_frames_and_rate_are_obeyed(trc, tmp_path):
    target = tmp_path / "walk.bvh"
    asked = ["--frames", "5:45", "--capture-fps", "60"]
    result = runner.invoke(app, ["convert", str(trc), str(target), *asked])
    assert result.exit_code == 0, result.output
    motion = rl.read(target)
    assert len(motion) == 40
    assert motion.fps == pytest.approx(60.0, rel=1e-3)


def test_what_is_missing_is_said_in_one_line(walk, tmp_path):
    names, places = markers(walk)
    chosen = [names.index(name) for name in ("LKNE", "RKNE", "LANK", "RANK", "C7")]
    path = written(tuple(names[c] for c in chosen), places[:, chosen], tmp_path / "few.trc")
    result = runner.invoke(app, ["convert", str(path), str(tmp_path / "few.bvh")])
    assert result.exit_code == 2
    said = " ".join(result.output.split())
    assert "no skeleton: a person needs" in said
    assert "convert --points" in said
    assert not (tmp_path / "few.bvh").exists()


@pytest.mark.filterwarnings("ignore::roundelay.base.errors.GapsFilled")
def test_gaps_stay_gaps_between_formats_of_points(trc, tmp_path):
    points = rl.read_points(trc)
    missing = points.missing.copy()
    missing[5:9, 2] = True
    holed, target = tmp_path / "holed.trc", tmp_path / "holed.c3d"
    rl.write(rl.Points(points.names, points.positions, 30.0, missing=missing, units="mm"), holed)
    result = runner.invoke(app, ["convert", str(holed), str(target), "--frames", "2:20"])
    assert result.exit_code == 0, result.output
    assert np.array_equal(rl.read_points(target).missing, missing[2:20])
    result = runner.invoke(app, ["convert", str(holed), str(target), "--max-gap", "1"])
    assert result.exit_code == 0, result.output
    assert not rl.read_points(target).missing.any()
