"""Search in libraries, and the distances it goes by."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.library.conftest import other_body

import roundelay as rl
from roundelay import synth
from roundelay.compare.neighbours import Finder, graph_of, has_usearch
from roundelay.compare.packed import Packed, pair_distances, unpacked
from roundelay.compare.spectra import Spectra, least_distances
from roundelay.cycles.edit.align import mirrored, shifted
from roundelay.geometry import rotations as rot
from roundelay.library.shelves import read_shelves


@pytest.fixture(scope="module")
def captured(jump_cycles, captures) -> list[rl.Cycle]:
    """A jump and a swing of one body, shifted and mirrored, too."""
    cycles = [jump_cycles[0], rl.find_cycles(rl.read(captures / "01_03.bvh"))[0]]
    return cycles + [mirrored(shifted(cycle, 0.37)) for cycle in cycles]


def nobody(cycle: rl.Cycle) -> rl.Cycle:
    """The cycle of a skeleton without a head: it is compared by its joints, as no person."""
    names = tuple("Skull" if name == "Head" else name for name in cycle.skeleton.names)
    return replace(cycle, skeleton=replace(cycle.skeleton, names=names))


def test_people_are_compared_whatever_their_skeletons(jumps):
    """Other names, units, headings: the motion is the same."""
    short = jumps[400:900]
    acclaim = {"LeftArm": "lhumerus", "RightArm": "rhumerus", "LeftHand": "lwrist"}
    turned = short.turned(rot.from_rotation_vector(np.array([0.0, 0.7, 0.0])))
    others = [short.scaled(3.0), turned, other_body(short), short.mirror()]
    others.append(renamed(short, acclaim | {"RightHand": "rwrist"}))
    spectra = Spectra.of_stretches(short, [(0, 500), (0, 100)])
    for other in others:
        apart = least_distances(Spectra.of_stretches(other, [(0, 500)]), spectra)[0]
        assert apart[0] < 2e-3 < 0.02 < apart[1]


def renamed(motion: rl.Motion, names: dict[str, str]) -> rl.Motion:
    kept = tuple(names.get(name, name) for name in motion.skeleton.names)
    return replace(motion, skeleton=replace(motion.skeleton, names=kept))


def test_packed_distances_are_those_of_all_pairs(captured, made):
    for cycles in (captured, list(map(nobody, captured))):
        spectra = Spectra.of(cycles)
        packed = Packed.of(spectra)
        one, other = (x.ravel() for x in np.indices((4, 4)))
        found = pair_distances(packed, packed, one, other).reshape(4, 4)
        expected = least_distances(spectra, spectra)
        assert np.abs(found - expected).max() < 1e-3
        vectors = packed.vectors()
        below = np.linalg.norm(vectors[:, None] - vectors, axis=2)
        assert np.all(below <= found + 1e-3)
        again = unpacked(packed, spectra.reflections[0])
        assert np.abs(again.waves - spectra.waves).max() < 1e-6


def test_distances_at_once_are_those_of_pairs(captured):
    cycles = list(map(nobody, captured))
    by_pairs = rl.distance_matrix(cycles, rl.cycle_distance)
    spectra = Spectra.of(cycles)
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
    cycle = nobody(synth_cycle("walk"))
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
    found, left_out = made[0].search(synth_cycle("walk"), 5)
    assert left_out == 0
    files = [match.file for match in found]
    walks = ["anna/walk.bvh", "ben/other.bvh", "ben/walk.amc", "ben/walk.bvh"]
    assert sorted(files[:4]) == walks
    distances = [match.distance for match in found]
    assert distances == sorted(distances)
    assert distances[3] < 0.5 * distances[4]
    assert len(made[0].search(synth_cycle("walk"), None)[0]) == len(made[0].behaviours) == 7


def test_what_is_done_once_is_found(made, shared):
    motion = rl.read(shared / "still.bvh")
    (match,), _ = made[0].search(motion, 1)
    assert (match.file, match.cycle["cycle"]) == ("still.bvh", None)
    assert match.distance < 1e-3
    slower, _ = made[0].search(motion.at(np.linspace(0, 299, 700)), 1)
    assert slower[0].file == "still.bvh"


def test_damaged_signatures_are_refused_when_they_are_met(made, tmp_path):
    copy = Path(shutil.copytree(made[0].folder, tmp_path / "copy"))
    path = copy / "signatures/0.values.npy"
    data = bytearray(path.read_bytes())
    data[-10] ^= 1
    path.write_bytes(bytes(data))
    with pytest.raises(rl.FormatError, match=r"a damaged signatures/0.values.npy; run roundelay"):
        rl.Library.open(copy)
    shelf = read_shelves(made[0].folder)[0]
    values = shelf.packed.values.copy()
    values[2, 5] += 0.1
    damaged = replace(shelf, packed=replace(shelf.packed, values=values))
    with pytest.raises(rl.FormatError, match="found damaged ones; run roundelay library again"):
        damaged.nearest(Spectra.of([synth_cycle("walk")]), 9)


def test_many_are_found_as_all_are(captured):
    """By vectors of all, and by a graph, where it is installed: nearly all that is nearest."""
    rng = np.random.default_rng(0)
    base = Packed.of(Spectra.of(captured)).values
    shares = rng.dirichlet(np.ones(4) / 2, 3000).astype(np.float32)
    noise = 0.0005 * rng.standard_normal((3000, base.shape[1])).astype(np.float32)
    packed = Packed(Spectra.of(captured).body, shares @ base + noise)
    queries = packed[np.arange(40)]
    whole = [pair_distances(packed, packed, np.full(3000, k), np.arange(3000)) for k in range(40)]
    finders = [Finder(packed)]
    if has_usearch():
        finders.append(Finder(packed, graph_of(packed.vectors())))
    for finder in finders:
        apart, rows = finder.nearest(queries, 10)
        for k, (distances, found) in enumerate(zip(apart, rows, strict=True)):
            best = np.sort(whole[k])[:10]
            assert found[0] == k
            assert np.mean(distances <= best[-1] + 1e-6) >= 0.9


def test_a_body_that_is_not_there_is_refused(made):
    motion = synth.gait("walk", repetitions=2.6).motion
    names = {name: f"bone{number}" for number, name in enumerate(motion.skeleton.names)}
    cycle = rl.find_cycles(renamed(motion, names))[0]
    with pytest.raises(rl.SkeletonMismatch, match="none of the library's 7 behaviours"):
        made[0].search(cycle)


def test_half_a_library_is_refused(made, tmp_path):
    with pytest.raises(rl.FormatError, match="expected a folder made by roundelay library"):
        rl.Library.open(tmp_path)
    text = (made[0].folder / "library.json").read_text()
    (tmp_path / "library.json").write_text(text)
    with pytest.raises(rl.FormatError, match=r"signatures/shelves\.json"):
        rl.Library.open(tmp_path)
    shutil.copytree(made[0].folder / "signatures", tmp_path / "signatures")
    assert rl.Library.open(tmp_path).summary == made[0].summary
    (tmp_path / "library.json").write_text(text.replace('"written": "', '"written": "1'))
    with pytest.raises(rl.FormatError, match=r"a damaged library\.json; run roundelay"):
        rl.Library.open(tmp_path)
