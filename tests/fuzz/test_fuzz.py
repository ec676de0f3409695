"""The kept corpus and a few thousand new files, in every run of the tests."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest
from tests.fuzz import holding, running
from tests.fuzz.grammar import FORMATS, made
from tests.fuzz.holding import changed, outcome
from tests.fuzz.keeping import captures, files_of, kept

import roundelay as rl

ENDS = ("accepted", "refused")


@pytest.mark.parametrize("path", captures(), ids=lambda path: path.name)
def test_the_kept_corpus(path):
    assert outcome(files_of(path)) in ENDS


@pytest.mark.parametrize("kind", FORMATS)
def test_files_by_the_grammar(kind):
    ends = Counter(outcome(made(kind, seed)) for seed in range(60))
    assert set(ends) <= set(ENDS)
    assert ends["accepted"] >= 20


def test_the_corpus_changed():
    corpus = kept()
    ends = {outcome(changed(corpus[seed % len(corpus)], seed, corpus)) for seed in range(120)}
    assert ends <= set(ENDS)


def test_the_same_seed_gives_the_same_files():
    for kind in FORMATS:
        assert made(kind, 5) == made(kind, 5) != made(kind, 6)


def test_what_ends_badly_is_noticed(monkeypatch):
    """A reader that raises something else, and one whose motions do not come back."""
    files = made("bvh", 0)
    assert outcome(files) == "accepted"
    motion = rl.read

    def broken(path):
        raise KeyError("a fault")

    with monkeypatch.context() as patch:
        patch.setattr(holding.rl, "read", broken)
        assert outcome(files) == "KeyError: 'a fault'"

    def shifting(path):
        found = motion(path)
        return found[1:] if path.stem == "again" and len(found) > 1 else found

    with monkeypatch.context() as patch:
        patch.setattr(holding.rl, "read", shifting)
        assert outcome(files).startswith("frames or rate changed")

    def turning(path):
        return motion(path).turned([np.cos(0.1), np.sin(0.1), 0, 0])

    with monkeypatch.context() as patch:
        patch.setattr(holding.rl, "read", turning)
        assert outcome(files).startswith("poses changed")


def test_counts_of_a_run(monkeypatch):
    monkeypatch.setattr(running, "BATCH", 12)
    counts = running.batch(0)["counts"]
    told = running.told(counts, {}, 1.0)
    assert told["fuzz_runs"] == 12
    assert told["other_exceptions"] == told["hangs"] == 0
    assert 0.2 <= told["accepted_share"] <= 1.0


def test_the_command():
    """Its processes find their work, which none does in a module called __main__."""
    command = [sys.executable, "-m", "tests.fuzz", "--runs", "1", "--jobs", "1"]
    run = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    told = json.loads(run.stdout)
    assert (told["fuzz_runs"], told["failed"]) == (running.BATCH, {})
