"""Points from and to datasets of xarray, as the library movement lays them out."""

import numpy as np
import pytest
import xarray

import roundelay as rl
from roundelay import synth


@pytest.fixture
def points():
    made = synth.gait("trot", repetitions=3.0, fps=50.0)
    return synth.as_points(made.motion, dimensions=2, gaps=0.1)


def test_there_and_back(points):
    dataset = points.to_dataset()
    assert dataset["position"].dims == ("time", "space", "keypoints", "individuals")
    assert np.isnan(dataset["position"].values).any()
    again = rl.Points.from_dataset(dataset)
    assert again.names == points.names
    assert again.fps == points.fps
    assert np.array_equal(again.missing, points.missing)
    assert np.array_equal(again.positions, points.positions)
    assert np.array_equal(again.likelihoods, points.seen)


def test_one_of_several_is_chosen(points):
    whole = points.to_dataset()
    other = whole.assign_coords(individuals=["second"])
    other["position"] = other["position"].where(other["time"] < 0.5)
    both = xarray.concat([whole.assign_coords(individuals=["first"]), other], "individuals")
    both.attrs["fps"] = 50.0
    assert rl.Points.from_dataset(both).name == "first"
    assert rl.Points.from_dataset(both, individual="second").missing[30:].all()
    with pytest.raises(ValueError, match="among first, second, found 'third'"):
        rl.Points.from_dataset(both, individual="third")


def test_an_array_without_individuals(points):
    array = points.to_dataset()["position"].isel(individuals=0, drop=True)
    found = rl.Points.from_dataset(array.transpose("keypoints", "time", "space"))
    assert found.fps == pytest.approx(50.0)
    assert np.array_equal(found.positions, points.positions)


def test_other_layouts_are_refused(points):
    array = points.to_dataset()["position"]
    with pytest.raises(ValueError, match="dimensions time, space, keypoints"):
        rl.Points.from_dataset(array.isel(space=0))
    with pytest.raises(ValueError, match="with a variable 'position', found Dataset"):
        rl.Points.from_dataset(xarray.Dataset({"other": array}))
    with pytest.raises(ValueError, match="with a variable 'position', found list"):
        rl.Points.from_dataset([1, 2])
    timeless = array.drop_vars("time")
    with pytest.raises(ValueError, match="give fps"):
        rl.Points.from_dataset(timeless)
    assert rl.Points.from_dataset(timeless, fps=25.0).fps == 25.0
