"""Fuzzing of all readers: a grammar, what must hold, and a kept corpus.

``python -m tests.fuzz --runs 100000`` makes files by the grammar, or changes those of the corpus,
and reads each. What ends in anything but a motion or an error of the format is kept in ``corpus/``
and replayed by the tests from then on. ``python -m tests.fuzz.guided bvh tests/fuzz/corpus`` does
the same guided by coverage, with atheris.
"""
