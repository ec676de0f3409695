import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roundelay.formats import decimals
from roundelay.formats.sane import LARGEST

FORMATS = ["{!r}", "{:.4f}", "{:.6f}", "{:g}", "{:.0f}.", "{:e}", "{:+.3f}", "{:.15g}", "{:09.2f}"]


@settings(max_examples=200, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.floats(-LARGEST, LARGEST), st.sampled_from(FORMATS), st.sampled_from(" \n\t\r\f")
        ),
    )
)
def test_every_number_is_the_nearest_double(values):
    text = "".join(form.format(value) + blank for value, form, blank in values)
    expected = np.array([float(word) for word in text.split()])
    np.testing.assert_array_equal(decimals.parse(text.encode()), expected)


def test_signs_of_zero_and_bare_points():
    values = decimals.parse(b" -0 -.5 5. +.25 0.0\n-0.000")
    np.testing.assert_array_equal(values, [0, -0.5, 5, 0.25, 0, 0])
    np.testing.assert_array_equal(np.signbit(values), [1, 1, 0, 0, 0, 1])


def test_blocks_join_without_a_seam(monkeypatch):
    numbers = np.random.default_rng(0).normal(size=500).round(4)
    text = " ".join(map(str, numbers)).encode()
    for size in (1, 7, 64):
        monkeypatch.setattr(decimals, "_BLOCK", size)
        np.testing.assert_array_equal(decimals.parse(text), numbers)


WORDS = "1-2 1.2.3 . - + +. -. .. 1e e5 E 1e+ nan inf -inf 1_0 0x1A --1 1+ 1,5 1e400 1.5e3.2 \0 ٣"


@pytest.mark.parametrize("word", [*WORDS.split(), "1" * 5000])
def test_words_that_are_no_numbers(word):
    assert decimals.parse(b"1 2 " + word.encode() + b" 3") is None
    assert not decimals.is_number(word.encode())


def test_nothing_is_no_numbers():
    assert decimals.parse(b"").size == decimals.parse(b" \n").size == 0
