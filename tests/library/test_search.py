"""Search in libraries, and the distances it goes by."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.library.conftest import other_body

import roundelay as rl
from roundelay import synth
from roundelay.compare.spectra import Spectra, least_distances
from roundelay.cycles.edit.align import mirrored, shifted


@pytest.fixture(scope="module")
def captured(jump_cycles, captures) -> list[rl.Cycle]:
    """A jump and a swing of one body, shifted and mirrored, too."""
    cycles = [jump_cycles[0], rl.find_cycles(rl.read(captures / "01_03.bvh"))[0]]
    return cycles + [mirrored(shifted(cycle, 0.37)) for cycle in cycles]


def test_distances_at_once_are_those_of_pairs(captured):
    by_pairs = rl.distance_matrix(captured, rl.cycle_distance)
    spectra = Spectra.of(captured)
    at_once = least_distances(spectra, spectra)
    apart = by_pairs > 0.05
    assert apart.sum() == 8
    assert np.abs(at_once - by_pairs)[apart].max() < 1e-4
    # Pairs are compared on a grid of offsets, on which 0.37 is not: equal cycles seem .001 apart.
    assert by_pairs[~apart].max() < 2e-3
    assert at_once[~apart].max() < 1e-3


def test_joints_may_come_in_another_order():
    cycle = synth_cycle("walk")
    order = [0, *range(13, 19), *range(1, 13)]
    moved = synth_cycle("walk", order=order)
    assert least_distances(Spectra.of([cycle]), Spectra.of([moved]))[0, 0] < 2e-4


def synth_cycle(kind: str, order: list[int] | None = None) -> rl.Cycle:
    motion = synth.gait(kind, repetitions=2.6).motion
    if order is not None:
        skeleton = motion.skeleton
        place = {joint: number for number, joint in enumerate(order)}
        motion = replace(
            motion,
            rotations=motion.rotations[:, order],
            skeleton=rl.Skeleton(
                tuple(skeleton.names[joint] for joint in order),
                tuple(place.get(skeleton.parents[joint], -1) for joint in order),
                skeleton.offsets[order],
                tuple((place[joint], end) for joint, end in skeleton.end_sites),
            ),
        )
    return rl.find_cycles(motion)[0]


def test_some_joints_are_enough():
    """The names of half a body's joints; sides of one skeleton can be told, of the other not."""
    cycle = synth_cycle("walk")
    names = tuple("Bone" + name if "Hand" in name else name for name in cycle.skeleton.names)
    odd = tuple("Left" if name == "RightForeArm" else name for name in names)
    for others in (names, odd):
        other = Spectra.of([replace(cycle, skeleton=replace(cycle.skeleton, names=others))])
        assert least_distances(Spectra.of([cycle]), other)[0, 0] < 2e-4
        assert least_distances(other, Spectra.of([cycle]))[0, 0] < 2e-4
    few = tuple(f"{name}_" if number > 8 else name for number, name in enumerate(names))
    other = Spectra.of([replace(cycle, skeleton=replace(cycle.skeleton, names=few))])
    assert least_distances(Spectra.of([cycle]), other)[0, 0] == np.inf


def test_sides_that_cannot_be_told_are_not_exchanged():
    cycle = synth_cycle("punch")
    names = tuple(f"joint{number}" for number in range(cycle.skeleton.n_joints))
    nameless = replace(cycle, skeleton=replace(cycle.skeleton, names=names))
    spectra = Spectra.of([nameless])
    assert np.array_equal(spectra.mirrored().waves, spectra.waves)


def test_the_nearest_cycles_are_of_the_same_kind(made):
    found, left_out = made[0].search(synth_cycle("walk"), 4)
    assert left_out == 1
    files = [match.file for match in found]
    assert sorted(files[:3]) == ["anna/walk.bvh", "ben/walk.amc", "ben/walk.bvh"]
    distances = [match.distance for match in found]
    assert distances == sorted(distances)
    assert distances[2] < 0.5 * distances[3]
    assert len(made[0].search(synth_cycle("walk"), None)[0]) == 5


def test_a_body_that_is_not_there_is_refused(made):
    cycle = rl.find_cycles(made_of_other_names())[0]
    with pytest.raises(rl.SkeletonMismatch, match="none of the library's 6 cycles"):
        made[0].search(cycle)


def made_of_other_names() -> rl.Motion:
    return other_body(other_body(synth.gait("walk", repetitions=2.6).motion))


def test_half_a_library_is_refused(made, tmp_path):
    with pytest.raises(rl.FormatError, match="expected a folder made by roundelay library"):
        rl.Library.open(tmp_path)
    text = (made[0].folder / "library.json").read_text()
    (tmp_path / "library.json").write_text(text)
    with pytest.raises(rl.FormatError, match=r"signatures\.npz"):
        rl.Library.open(tmp_path)
    (tmp_path / "signatures.npz").write_bytes((made[0].folder / "signatures.npz").read_bytes())
    assert rl.Library.open(tmp_path).summary == made[0].summary
    (tmp_path / "library.json").write_text(text.replace('"written": "', '"written": "1'))
    with pytest.raises(rl.FormatError, match=r"a damaged library\.json; run roundelay"):
        rl.Library.open(tmp_path)
