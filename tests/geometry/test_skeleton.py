import numpy as np
import pytest

from roundelay import Skeleton, SkeletonMismatch

NAMES = ("root", "a", "b", "c")
OFFSETS = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], float)


@pytest.fixture
def skeleton():
    return Skeleton(NAMES, (-1, 0, 1, 0), OFFSETS, ((2, np.array([0, 4.0, 0])),), layout="kept")


def test_queries(skeleton):
    assert skeleton.n_joints == 4
    assert skeleton.index("b") == 2
    np.testing.assert_array_equal(skeleton.indices(["c", "root"]), [3, 0])
    assert skeleton.descendants(1) == [1, 2]
    assert [level.tolist() for level in skeleton.levels] == [[0], [1, 3], [2]]
    np.testing.assert_array_equal(skeleton.bone_lengths, [4, 2, 4, 0])


def test_size_is_the_longest_path_between_two_ends(skeleton):
    assert skeleton.size == 1 + 2 + 4 + 3
    assert Skeleton(("root",), (-1,), np.zeros((1, 3))).size == 1.0


def test_scaled(skeleton):
    double = skeleton.scaled(2.0)
    np.testing.assert_array_equal(double.offsets, 2 * OFFSETS)
    np.testing.assert_array_equal(double.end_sites[0][1], [0, 8, 0])
    assert double.size == 2 * skeleton.size
    assert double.layout == "kept"


def test_offsets_are_a_frozen_copy(skeleton):
    with pytest.raises(ValueError, match="read-only"):
        skeleton.offsets[0] = 1.0
    mine = OFFSETS.copy()
    made = Skeleton(NAMES, (-1, 0, 1, 0), mine)
    mine[1] = 9.0
    np.testing.assert_array_equal(made.offsets, OFFSETS)


def test_an_unknown_joint_is_answered_with_those_there_are(skeleton):
    with pytest.raises(SkeletonMismatch, match="no joint 'x'; the joints are root, a, b, c"):
        skeleton.index("x")


@pytest.mark.parametrize(
    ("names", "parents", "offsets", "ends", "message"),
    [
        ((), (), np.zeros((0, 3)), (), "at least one"),
        (NAMES, (-1, 0, 1), OFFSETS, (), "3 parents"),
        (NAMES, (-1, 0, 1, 0), OFFSETS[:, :2], (), r"shape \(4, 2\)"),
        (("a", "b", "c", "a"), (-1, 0, 1, 0), OFFSETS, (), "names to be different"),
        (NAMES, (-1, 2, 0, 0), OFFSETS, (), "every parent before its children"),
        (NAMES, (-1, -1, 0, 0), OFFSETS, (), "one root"),
        (NAMES, (0, 0, 0, 0), OFFSETS, (), "one root"),
        (NAMES, (-1, 0, 1, 0), OFFSETS * np.nan, (), "finite"),
        (NAMES, (-1, 0, 1, 0), OFFSETS, ((4, OFFSETS[0]),), "end site"),
    ],
)
def test_what_is_no_tree(names, parents, offsets, ends, message):
    with pytest.raises(ValueError, match=message):
        Skeleton(names, parents, offsets, ends)


def test_require_same(skeleton):
    skeleton.require_same(skeleton.scaled(3.0))
    other = Skeleton(("root", "a", "b", "d"), (-1, 0, 1, 0), OFFSETS)
    with pytest.raises(SkeletonMismatch, match="only in the first: c; only in the second: d"):
        skeleton.require_same(other)
    moved = Skeleton(NAMES, (-1, 0, 0, 0), OFFSETS)
    with pytest.raises(SkeletonMismatch, match="another order or on other parents"):
        skeleton.require_same(moved)
