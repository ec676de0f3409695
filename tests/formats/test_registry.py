import pytest

import roundelay as rl


def test_an_unknown_suffix_lists_those_known(tmp_path, bvh):
    expected = r"expected a file of type \.bvh, \.amc"
    with pytest.raises(rl.FormatError, match=expected):
        rl.read("a.xyz")
    with pytest.raises(ValueError, match=expected):
        rl.write(rl.read(bvh()), tmp_path / "a.xyz")


def test_suffixes_in_capitals(bvh):
    assert len(rl.read(bvh(name="A.BVH"))) == 3


def test_paths_as_text(bvh, tmp_path):
    motion = rl.read(str(bvh()))
    rl.write(motion, str(tmp_path / "b.bvh"))
    assert len(rl.read(str(tmp_path / "b.bvh"))) == 3


def test_a_bvh_takes_no_skeleton(bvh):
    with pytest.raises(ValueError, match="holds its own"):
        rl.read(bvh(), skeleton="a.asf")


def test_a_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        rl.read(tmp_path / "none.bvh")
