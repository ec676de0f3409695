"""Spans of frames: the one type for them."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roundelay.base.spans import Spans, closed_spans

masks = st.lists(st.booleans(), min_size=1, max_size=40).map(lambda x: np.array(x, bool))


def test_spans_are_pairs_to_everybody_else():
    spans = Spans([[3, 5], np.array([5, 9])])
    assert spans == ((3, 5), (5, 9))
    assert hash(spans) == hash(((3, 5), (5, 9)))
    assert json.dumps(spans) == "[[3, 5], [5, 9]]"
    assert str(spans) == "3-5, 5-9"
    assert Spans(spans) is spans
    assert all(type(end) is int for span in spans for end in span)


@pytest.mark.parametrize(
    "wrong", [[(5, 3)], [(-1, 2)], [(0, 4), (3, 6)], [(4, 6), (0, 2)], [(1.5, 3)], [7], [(1, 2, 3)]]
)
def test_wrong_pairs_are_refused(wrong):
    with pytest.raises(ValueError, match=r"expected .* found"):
        Spans(wrong)


@given(masks)
def test_masks_there_and_back(mask):
    spans = Spans.of_mask(mask)
    again = np.zeros(len(mask), bool)
    again[spans.frames] = True
    assert np.array_equal(again, mask)
    assert spans.total == mask.sum()
    assert spans.lengths == [stop - start for start, stop in spans]
    assert Spans.union(spans) == spans


@given(masks)
def test_joined_spans_hold_the_same_frames_end_to_end(mask):
    spans = Spans.of_mask(mask)
    values = np.arange(len(mask))
    taken = values[spans.frames]
    for own, joined in zip(spans.slices(), spans.joined.slices(), strict=True):
        assert np.array_equal(values[own], taken[joined])


def test_union_joins_what_meets():
    assert Spans.union([(0, 4), (2, 3), (4, 6), (8, 9)]) == ((0, 6), (8, 9))
    assert Spans.union([]) == ()
    assert Spans().frames.dtype == np.intp


@given(masks)
def test_closed_spans_go_on_across_the_seam(mask):
    spans = closed_spans(mask)
    marked = np.zeros(len(mask), int)
    for start, stop in spans:
        assert 0 <= start < len(mask)
        marked[np.arange(start, stop) % len(mask)] += 1
    assert np.array_equal(marked, mask.astype(int))


def test_ranges_are_moved():
    spans = Spans([(3, 5), (7, 9)])
    assert spans.moved(2) == ((5, 7), (9, 11))
    assert spans.moved(2).moved(-2) == spans
    with pytest.raises(ValueError, match="from 0 on"):
        spans.moved(-4)


def test_without_leaves_what_others_do_not_take():
    spans = Spans([(0, 10), (12, 20), (30, 40)])
    left = spans.without(Spans([(3, 5), (9, 13), (28, 41)]))
    assert left == ((0, 3), (5, 9), (13, 20))
    assert spans.without(Spans([(3, 5)]), shortest=4) == ((5, 10), (12, 20), (30, 40))
    assert Spans().without(spans) == ()
