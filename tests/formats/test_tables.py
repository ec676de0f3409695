"""Tables of numbers: what is empty, what is odd, and where."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import roundelay as rl
from roundelay.formats.tables import rate_of, read_table
from roundelay.formats.text import Source


def read(text, columns, separator=b"\t", **others):
    return read_table(Source(Path("a.txt"), text.encode()), 0, columns, separator, **others)


def test_empty_fields_are_nan():
    table = read("1\t\t3\n\t nan \t-2.5e1\n", 3)
    assert np.array_equal(table.values, [[1, np.nan, 3], [np.nan, np.nan, -25]], equal_nan=True)


def test_line_ends_blank_lines_and_quotes():
    table = read('1,"2"\r\n\r\n  \n3,4', 2, b",")
    assert table.values.tolist() == [[1, 2], [3, 4]]


def test_white_space():
    assert read(" 1   2\t3\n4 5 6 \n", 3, None).values.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_what_is_empty_beyond_the_last_column_is_left_out():
    assert read("1\t2\t\t\n3\t4\n", 2).values.tolist() == [[1, 2], [3, 4]]
    assert read("1\t2\t9\n3\t4\n", 2, cropped=True).values.tolist() == [[1, 2], [3, 4]]


def test_many_blocks():
    values = np.arange(400_000.0).reshape(-1, 4)
    text = "".join("\t".join(map(str, row)) + "\n" for row in values.tolist())
    assert np.array_equal(read(text, 4).values, values)


def test_decimal_commas():
    with pytest.warns(rl.RoundelayWarning, match="decimal commas read as decimal points"):
        assert read("1,5;2\n3;4,25\n", 2, b";").values.tolist() == [[1.5, 2], [3, 4.25]]
    with pytest.raises(rl.FormatError, match=r"a.txt:1:1: .*found '1,5'; write decimal points"):
        read("1,5\t2.5\n", 2)


@pytest.mark.parametrize(
    ("text", "separator", "told"),
    [
        ("1\t2\n3\n", b"\t", "a.txt:2:2: expected 2 fields, found 1"),
        ("1\t2\n3\t4\t5\n", b"\t", "a.txt:2:6: expected 2 fields, found 3"),
        ("1 2\n3\n", None, "a.txt:2:2: expected 2 fields, found 1"),
        ("1,2\n3,x\n", b",", "a.txt:2:3: expected a number, found 'x'"),
        ("1,2\n3,inf\n", b",", "a.txt:2:3: expected a number, found 'inf'"),
        ("1,2\n3,1e13\n", b",", "a.txt:2:3: expected a number, found '1e13'"),
        ("1\t2 3\n", b"\t", "a.txt:1:3: expected a number, found '2 3'"),
        ("\n\n", b"\t", "expected rows of numbers, found none"),
    ],
)
def test_what_is_odd_is_refused_with_its_place(text, separator, told):
    with pytest.raises(rl.FormatError, match=told):
        read(text, 2, separator)


def test_frames_that_are_skipped_are_empty():
    table = read("7\t1\n8\t2\n10\t4\n", 2).numbered(0)
    assert np.array_equal(table.values[:, 1], [1, 2, np.nan, 4], equal_nan=True)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("1\t1\n1\t2\n", "a.txt:2:1: expected frame numbers that grow, found 1 after 1"),
        ("1\t1\n2.5\t2\n", "a.txt:2:1: expected a whole frame number"),
        ("1\t1\n\t2\n", "a.txt:2:1: expected a whole frame number"),
        ("1\t1\n999999999\t2\n", "without large gaps, found 999999999 after 1"),
    ],
)
def test_odd_frame_numbers_are_refused(text, told):
    with pytest.raises(rl.FormatError, match=told):
        read(text, 2).numbered(0)


def test_rates_of_times():
    assert rate_of(np.arange(100) / 120.0) == 120.0
    assert rate_of(np.round(np.arange(1000) / 60.0, 3)) == 60.0
    assert rate_of(np.arange(100) / 119.3) == pytest.approx(119.3)
    assert rate_of(np.array([0.0])) is None
    assert rate_of(np.array([1.0, 0.0])) is None
