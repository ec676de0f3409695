"""One vocabulary: names are the same in all files and stay, whatever is added in what order."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from tests.library.conftest import write_gait
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.compare.packed import Packed
from roundelay.compare.spectra import Body, Spectra
from roundelay.library.groups import assigned, clusters, nearest_named
from roundelay.library.names import named_by_files, words_of
from roundelay.library.query import answer
from roundelay.library.shelves import Shelf

runner = CliRunner()


def run(*arguments):
    return runner.invoke(app, [*map(str, arguments)])


@pytest.fixture
def copy(made, tmp_path):
    return Path(shutil.copytree(made[0].folder, tmp_path / "copy"))


def groups(library: rl.Library) -> dict[str, list[int]]:
    return {clip["file"]: [one["group"] for one in clip["cycles"]] for clip in library.clips}


def test_a_name_is_that_of_all_alike_behaviours(made, copy):
    (group,) = groups(made[0])["anna/walk.bvh"]
    result = run("name", copy, group, " walk ")
    assert result.exit_code == 0, result.output
    assert "walk; for example" in result.stdout
    sql = "SELECT DISTINCT clip FROM behaviours WHERE name = 'walk' ORDER BY 1"
    clips = [row[0] for row in answer(copy, sql).rows]
    assert clips == ["anna/walk.bvh", "ben/other.bvh", "ben/walk.amc", "ben/walk.bvh"]
    told = answer(copy, f"SELECT name, named_by FROM groups WHERE group_number = {group}").rows
    assert told == [("walk", "person")]
    run("name", copy, group, "--forget")
    assert answer(copy, sql).rows == [(clip,) for clip in clips]  # so are the files called
    (one,) = [x for x in rl.Library.open(copy).record["groups"] if x["group"] == group]
    assert one["named_by"] == "files"


def test_a_name_stays_when_clips_come_and_are_done_again(clips, tmp_path):
    folder = tmp_path / "library"
    first = rl.build_library(clips, folder, jobs=1)
    (walk,), (run_,) = groups(first).values()
    run("name", folder, walk, "stroll")
    write_gait(clips / "aaron.bvh", "walk", seed=9)
    write_gait(clips / "zoe.bvh", "jacks", seed=8)
    second = rl.build_library(clips, folder, jobs=1)
    told = groups(second)
    assert told["anna/take.bvh"] == told["aaron.bvh"] == [walk]
    assert told["ben/take.bvh"] == [run_]
    assert told["zoe.bvh"][0] not in (walk, run_)
    assert {one["name"] for one in second.clips[0]["cycles"]} == {"stroll"}
    again = rl.build_library(clips, folder, jobs=1, again=True)
    assert groups(again) == told
    (folder / "library.json").write_text("{}")
    with pytest.warns(rl.RoundelayWarning, match=r"mended: damaged: library\.json"):
        mended = rl.build_library(clips, folder, jobs=1)
    assert groups(mended) == told
    assert {one["name"] for one in mended.clips[0]["cycles"]} == {"stroll"}


def test_a_number_is_not_given_twice(clips, tmp_path):
    folder = tmp_path / "library"
    first = groups(rl.build_library(clips, folder, jobs=1))
    (clips / "ben" / "take.bvh").unlink()
    rl.build_library(clips, folder, jobs=1)
    write_gait(clips / "carl.bvh", "jacks", seed=5)
    third = groups(rl.build_library(clips, folder, jobs=1))
    assert third["carl.bvh"][0] > max(number for one in first.values() for number in one)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["99", "walk"], "expected one of the library's 4 groups, found 99"),
        (["0", ""], "expected a name of 1 to 100 letters in one line, found ''"),
        (["0", "a\nb"], "in one line"),
        (["0"], "expected a name for the group, or --forget"),
        (["0", "walk", "--forget"], "expected a name for the group, or --forget"),
    ],
)
def test_what_cannot_be_a_name(copy, arguments, said):
    before = (copy / "clips.jsonl").read_bytes()
    result = run("name", copy, *arguments)
    assert result.exit_code == 2
    assert said in result.stderr
    assert result.stderr.count("\n") == 1
    assert (copy / "clips.jsonl").read_bytes() == before


def test_groups_are_listed(made):
    listed = run("name", made[0].folder).stdout.splitlines()
    assert len(listed) == 1 + len(made[0].record["groups"])
    assert listed[1].split()[1] == "4"  # behaviours of the largest
    assert json.loads(run("name", made[0].folder, "--json").stdout) == made[0].record["groups"]
    assert "expected a folder made by" in run("name", made[0].folder / "loops").stderr


def test_words_of_files():
    assert words_of("dataset-1_walk_oldMan_001") == {*("dataset", "walk", "old", "man")}
    shown = [["walk_a", "walk_b"], ["run_a", "jog_b", "run_c"], ["x/1"], ["hop/1", "hop/2"]]
    clips = [
        {"file": file, "segments": [], "cycles": [{"group": group}]}
        for group, files in enumerate(shown)
        for file in files
    ]
    assert named_by_files(clips) == {0: "walk", 1: "run", 3: "hop"}


BODY = Body(("hips", "knee", "head"), (0, 1, 2))


def blobs(seed: int, each: int = 12) -> tuple[Packed, np.ndarray]:
    """Signatures about six places, some with hardly more between them than within."""
    rng = np.random.default_rng(seed)
    places = 0.3 * np.random.default_rng(0).standard_normal((6, 3, 3))
    kinds = np.repeat(np.arange(6), each)
    means = places[kinds] + 0.008 * rng.standard_normal((len(kinds), 3, 3))
    waves = np.zeros((len(kinds), 8, 3, 3), np.complex64)
    across = np.ones((len(kinds), 3), np.float32)
    return Packed.of(Spectra(BODY, means.astype(np.float32), waves, across)), kinds


def same(first: np.ndarray, second: np.ndarray) -> bool:
    """Whether two labellings are one but for their numbers."""
    return len(set(zip(first, second, strict=True))) == len(set(first)) == len(set(second))


def test_likeness_suggests_names():
    packed, kinds = blobs(3)
    shelf = Shelf(np.arange(len(kinds)), packed)
    labels = kinds.copy()
    labels[1::2] += 6  # each place twice, as two groups
    named = {0: "walk", 1: "run"}
    found = nearest_named([shelf], labels, named)
    assert found == {6: "walk", 7: "run"}
    assert nearest_named([shelf], labels, {0: "walk"}) == {6: "walk"}


def test_groups_are_found_whatever_the_order():
    packed, kinds = blobs(1)
    labels = clusters(packed)
    assert same(labels, kinds)
    for seed in range(3):
        order = np.random.default_rng(seed).permutation(len(kinds))
        assert same(clusters(packed[order]), labels[order])


def test_what_is_added_changes_no_group():
    packed, kinds = blobs(2)
    few = np.arange(0, len(kinds), 5)
    shelf = Shelf(np.arange(len(few)), packed[few])
    first = assigned([shelf], np.full(len(few), -1), {})
    known = np.full(len(kinds), -1)
    known[few] = first.labels
    whole = Shelf(np.arange(len(kinds)), packed)
    second = assigned([whole], known, first.founded)
    assert np.array_equal(second.labels[few], first.labels)
    assert not second.founded
    assert same(second.labels, kinds)
    # Without what was known of the members, the examples are enough.
    third = assigned([whole], np.full(len(kinds), -1), first.founded)
    assert np.array_equal(third.labels, second.labels)
