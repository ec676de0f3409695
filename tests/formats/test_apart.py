"""Files that are read in a process of their own."""

import numpy as np
import pytest

from roundelay.base.errors import FormatError
from roundelay.formats.apart import Library, read_apart

CHILD = """
from roundelay.formats.apart import answer


def read(path, word):
    text = path.read_text()
    if "bad" in text:
        raise ValueError("line one\\n and what is  wrong")
    return {"text": [text], "suffix": [path.suffix], "word": [word]}


answer(read)
"""


@pytest.fixture
def library(tmp_path, monkeypatch):
    (tmp_path / "reading_child.py").write_text(CHILD)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    return Library("numpy", "numpy", "none", "reading_child", "words")


def test_what_the_process_read_comes_back(library, tmp_path):
    asked = (library, tmp_path / "a.x", b"good", ".x", ["third"])
    with read_apart(*asked) as made, np.load(made) as found:
        told = {name: found[name].tolist() for name in found}
    assert told == {"text": ["good"], "suffix": [".x"], "word": ["third"]}
    assert not made.exists()


def test_its_last_words_are_the_error(library, tmp_path):
    with (
        pytest.raises(FormatError, match="expected words, found: line one and what is wrong"),
        read_apart(library, tmp_path / "a.x", b"bad", ".x", ["third"]),
    ):
        pass
