"""Our own pass the checks of `roundelay.testing`, and what is wrong does not."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth, testing
from roundelay.base.files import written_beside
from roundelay.cycles.models import cycle_models
from roundelay.cycles.models.regression import Harmonic
from roundelay.formats import readers, suffixes_of, writers
from roundelay.formats.bvh import BvhReader
from roundelay.formats.bvh_writer import BvhWriter
from roundelay.formats.registry import reader_of
from roundelay.loops.profiles import Generic, profiles
from roundelay.segmentation import Curve, Cuts, segmentation_methods
from roundelay.testing import expecting
from roundelay.testing import readers as of_readers
from roundelay.timeline.proposals import Candidate, proposers

# What takes a process a file, by a library that may not be there.
APART = ("usd",)


@pytest.fixture(scope="module")
def samples(tmp_path_factory) -> dict[str, list[Path]]:
    """Small files that our writers made, by the name of their reader."""
    folder, made = tmp_path_factory.mktemp("samples"), {}
    motion = synth.gait("walk", repetitions=0.5, fps=30).motion
    for reader in readers:
        if reader.name in APART:
            made[reader.name] = []
            continue
        written = [suffix for suffix in reader.suffixes if suffix in suffixes_of(writers)]
        made[reader.name] = [folder / f"walk{suffix}" for suffix in written]
        for path in made[reader.name]:
            rl.write(motion, path)
        # Of two readers of one suffix the other may get what our writer writes.
        made[reader.name] = [p for p in made[reader.name] if reader_of(p).name == reader.name]
    return made


@pytest.mark.parametrize("name", readers.names())
def test_our_readers(name, samples):
    if not samples[name]:
        pytest.skip("its own tests check it by files of others")
    testing.check_reader(readers[name], samples[name])


@pytest.mark.parametrize("name", [name for name in writers.names() if name not in APART])
def test_our_writers(name):
    reader = readers[name] if name in readers.names() else None
    testing.check_writer(writers[name], reader)


@pytest.mark.parametrize("name", proposers.names())
def test_our_proposers(name):
    testing.check_proposer(proposers[name])


@pytest.mark.parametrize("name", cycle_models.names())
def test_our_cycle_models(name):
    testing.check_cycle_model(cycle_models[name])


@pytest.mark.parametrize("name", segmentation_methods.names())
def test_our_segmentation_methods(name):
    testing.check_segmentation_method(segmentation_methods[name])


@pytest.mark.parametrize("name", profiles.names())
def test_our_profiles(name):
    testing.check_profile(profiles[name])


class Nameless(BvhReader):
    name = ""


class Dotless(BvhReader):
    suffixes = ("bvh",)


class Crashing(BvhReader):
    def read(self, path):
        try:
            return super().read(path)
        except rl.FormatError as error:
            raise IndexError from error


class Trusting(BvhReader):
    """Takes whatever is broken for a motion."""

    def read(self, path):
        try:
            return super().read(path)
        except rl.FormatError:
            return synth.gait("walk", repetitions=0.5).motion


class Moody(BvhReader):
    def read(self, path):
        return replace(super().read(path), frame_time=time.perf_counter())


class Careless(BvhReader):
    def read(self, path):
        motion = super().read(path)
        path.write_bytes(path.read_bytes() + b"\n")
        return motion


class Hanging(BvhReader):
    def read(self, path):
        try:
            return super().read(path)
        except rl.FormatError:
            time.sleep(1.0)
            raise


@pytest.mark.parametrize(
    ("reader", "complaint"),
    [
        (Nameless, "expected a name"),
        (Dotless, "expected suffixes like"),
        (Crashing, "expected a FormatError for an empty file .*, found IndexError"),
        (Trusting, "expected a FormatError for an empty file .*, found a motion"),
        (Moody, "expected the same motion again"),
        (Careless, "expected a sample left as it is"),
        (Hanging, "expected an end within 0.5 s of reading an empty file"),
    ],
)
def test_readers_that_do_not_pass(reader, complaint, samples, monkeypatch):
    monkeypatch.setattr(of_readers, "SECONDS", 0.5 if reader is Hanging else expecting.SECONDS)
    with pytest.raises(AssertionError, match=complaint):
        testing.check_reader(reader(), samples["bvh"])


def test_a_reader_needs_samples():
    with pytest.raises(AssertionError, match="expected at least one sample"):
        testing.check_reader(BvhReader(), [])


class InPlace(BvhWriter):
    """Opens the file itself."""

    def write(self, motion, path):
        with path.open("w") as file, written_beside(path.with_stem("other")) as part:
            super().write(motion, part)
            file.write(part.read_text())
        path.with_stem("other").unlink()


class Littering(BvhWriter):
    def write(self, motion, path):
        super().write(motion, path)
        path.with_name("log.txt").write_text("done")


class Shifting(BvhWriter):
    def write(self, motion, path):
        super().write(replace(motion, rotations=np.roll(motion.rotations, 1, axis=0)), path)


class Stamping(BvhWriter):
    def write(self, motion, path):
        super().write(replace(motion, frame_time=0.1 + 1e-3 * time.perf_counter() % 0.1), path)


class Silent(BvhWriter):
    def write(self, motion, path):
        if path.parent.exists() and not path.is_dir():
            super().write(motion, path)


@pytest.mark.parametrize(
    ("writer", "complaint"),
    [
        (InPlace, "expected a file that is replaced when whole"),
        (Littering, "expected files named loop, found log.txt"),
        (Shifting, "expected joints within"),
        (Stamping, "expected the same bytes"),
        (Silent, "expected an OSError for a folder in its place, found none"),
    ],
)
def test_writers_that_do_not_pass(writer, complaint):
    with pytest.raises(AssertionError, match=complaint):
        testing.check_writer(writer(), BvhReader())


def proposing(*candidates: Candidate) -> object:
    class Fixed:
        name = "fixed"

        def propose(self, body) -> Iterator[Candidate]:
            yield from candidates

    return Fixed()


class Endless:
    name = "endless"

    def propose(self, body):
        while True:
            yield Candidate("body", 0, len(body), 4.0)


class Spoiling:
    name = "spoiling"

    def propose(self, body):
        body.signals[:] = 0.0
        yield Candidate("body", 0, len(body), 4.0)


class Counting:
    name = "counting"
    asked = 0

    def propose(self, body):
        self.asked += 2
        yield Candidate("body", 0, self.asked, 1.0)


class Whereabouts:
    name = "whereabouts"

    def propose(self, body):
        if body.limbs:
            yield Candidate("body", 0, len(body), 4.0 + body.span[0] / 20)


@pytest.mark.parametrize(
    ("proposer", "complaint"),
    [
        (proposing(Candidate("body", 0, 10**6, 10.0)), "expected samples within 0 and"),
        (proposing(Candidate("body", 0, 4, 10**6)), "expected a period above 0"),
        (proposing(Candidate("body", 2, 2, 1.0)), "expected samples within 0 and"),
        (proposing(Candidate("tail", 0, 4, 2.0)), "expected a group of"),
        (proposing(Candidate("body", 0, 4, 2.0, np.zeros(3))), "expected a phase for each"),
        (Whereabouts(), "expected candidates that move with the take"),
        (proposing("walk"), "expected a Candidate"),
        (Endless(), "expected at most 1000 candidates"),
        (Spoiling(), "expected signals left as they are"),
        (Counting(), "expected the same candidates again"),
    ],
)
def test_proposers_that_do_not_pass(proposer, complaint):
    with pytest.raises(AssertionError, match=complaint):
        testing.check_proposer(proposer)


class Doubled(Harmonic):
    def fit(self, motion, phase, evidence, options):
        cycle = super().fit(motion, phase, evidence, options)
        return replace(cycle, period=2.0 * cycle.period)


class Forgetful(Harmonic):
    def fit(self, motion, phase, evidence, options):
        return replace(super().fit(motion, phase, evidence, options), evidence=None)


class Still(Harmonic):
    def fit(self, motion, phase, evidence, options):
        cycle = super().fit(motion, phase, evidence, options)
        pose = cycle.pose
        still = type(pose)(pose.frequencies, pose.constant, 0.0 * pose.sine, 0.0 * pose.cosine)
        return replace(cycle, pose=still)


class Absolute(Harmonic):
    """Depends on how many turns were made before."""

    def fit(self, motion, phase, evidence, options):
        return super().fit(motion, phase + 0.05 * np.nanmin(phase), evidence, options)


class Guessing(Harmonic):
    def fit(self, motion, phase, evidence, options):
        try:
            return super().fit(motion, phase, evidence, options)
        except rl.TooShort:
            raise ZeroDivisionError from None


@pytest.mark.parametrize(
    ("model", "complaint"),
    [
        (Doubled, "expected a period near 1.100 s"),
        (Forgetful, "expected the evidence in the cycle"),
        (Still, "expected a (template error|step across the seam)"),
        (Absolute, "expected the same cycle of a phase three turns on"),
        (Guessing, "expected a cycle or TooShort for a phase that stands still"),
    ],
)
def test_models_that_do_not_pass(model, complaint):
    with pytest.raises(AssertionError, match=complaint):
        testing.check_cycle_model(model())


def cutting(**changes: object) -> object:
    """Return the method pca, with what it finds changed."""

    class Changed:
        name, options = "changed", segmentation_methods["pca"].options

        def find(self, channels, options) -> Cuts:
            found = segmentation_methods["pca"].find(channels, options)
            return replace(found, **changes)

    return Changed()


@pytest.mark.parametrize(
    ("method", "complaint"),
    [
        (cutting(frames=[10, 10], strengths=[1.0, 1.0]), "expected cuts that grow"),
        (cutting(frames=[10.5], strengths=[1.0]), "expected cuts as whole numbers"),
        (cutting(frames=[10], strengths=[]), "expected 1 strengths, found 0"),
        (cutting(frames=[10], strengths=[1.0], labels=[0]), "expected 2 labels, found 1"),
        (cutting(frames=[10], strengths=[1.0], labels=[1, 0]), "numbered by first appearance"),
        (cutting(frames=[10], strengths=[np.nan]), "expected strengths that are numbers"),
        (cutting(curve=Curve(np.zeros(2), np.zeros(3), "x")), "expected a curve"),
    ],
)
def test_methods_that_do_not_pass(method, complaint):
    with pytest.raises(AssertionError, match=complaint):
        testing.check_segmentation_method(method)


class Arrays(Generic):
    def record(self, cycle, sampling, mended=()):
        return super().record(cycle, sampling, mended) | {"travel": cycle.travel}


class Timed(Generic):
    def record(self, cycle, sampling, mended=()):
        return {"written": time.perf_counter()}


class Infinite(Generic):
    def record(self, cycle, sampling, mended=()):
        return {"period": float("nan")}


@pytest.mark.parametrize(
    ("profile", "complaint"),
    [
        (Arrays, "expected JSON, found Object of type ndarray"),
        (Timed, "expected the same record again"),
        (Infinite, "expected JSON, found Out of range float"),
    ],
)
def test_profiles_that_do_not_pass(profile, complaint):
    with pytest.raises(AssertionError, match=complaint):
        testing.check_profile(profile())
