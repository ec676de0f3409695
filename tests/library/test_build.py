"""Libraries of many clips: what is in them, what is done again, what is never lost."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tests.library.conftest import write_gait

import roundelay as rl


def records(library: rl.Library) -> dict[str, dict]:
    return {clip["file"]: clip for clip in library.clips}


def test_every_capture_has_a_record(made):
    library, _ = made
    assert list(records(library)) == [
        "anna/punch.BVH",
        "anna/walk.bvh",
        "ben/jacks.bvh",
        "ben/other.bvh",
        "ben/walk.amc",
        "ben/walk.bvh",
        "broken.bvh",
        "still.bvh",
    ]
    walk = records(library)["anna/walk.bvh"]
    (cycle,) = walk["cycles"]
    assert cycle["period_seconds"] == pytest.approx(1.1, rel=0.01)
    assert cycle["parts"] == [[0, walk["frames"]]]
    travelled = np.linalg.norm(cycle["travel"])
    assert cycle["speed"] * cycle["period_seconds"] == pytest.approx(travelled, rel=1e-3)
    loop = rl.read(library.folder / cycle["loop"])
    assert len(loop) == cycle["loop_frames"] == 132
    assert cycle["confidence"] > 0.5
    assert cycle["quality"]["coverage"] == 1.0


def test_a_bad_file_costs_one_line(made):
    library, refused = made
    assert len(refused) == 1
    assert refused[0].startswith("broken.bvh:")
    assert records(library)["broken.bvh"]["error"] == refused[0]
    assert library.summary["refused"] == 1


def test_a_capture_without_a_period_has_the_reason(made):
    still = records(made[0])["still.bvh"]
    assert still["error"] is None
    assert still["cycles"] == []
    assert still["reason"].startswith("no periodic motion found")


def test_equal_motions_bear_equal_labels_in_all_clips(made):
    clips = records(made[0])
    group = {name: [cycle["group"] for cycle in clip["cycles"]] for name, clip in clips.items()}
    assert group["anna/walk.bvh"] == group["ben/walk.bvh"] == group["ben/walk.amc"]
    kinds = [group[name][0] for name in ("anna/walk.bvh", "anna/punch.BVH", "ben/jacks.bvh")]
    assert len(set(kinds)) == 3
    # A person is one whatever the joints are called.
    assert group["ben/other.bvh"] == group["anna/walk.bvh"]
    assert [row["cycles"] for row in made[0].record["groups"]] == [1, 4, 1, 0]
    (segment,) = clips["anna/walk.bvh"]["segments"]
    assert segment["group"] == group["anna/walk.bvh"][0]


def test_the_table_has_a_row_a_cycle(made):
    rows = (made[0].folder / "cycles.csv").read_text().splitlines()
    assert len(rows) == 1 + made[0].summary["loops"]
    assert rows[0].startswith("file,frames,group,name,period_seconds")
    assert rows[0].endswith(",verdict")
    assert {row.rpartition(",")[2] for row in rows[1:]} <= {"good", "look", "do not use"}


def test_loops_of_one_name_do_not_collide(clips, tmp_path):
    library = rl.build_library(clips, tmp_path / "library", jobs=1)
    loops = [cycle["loop"] for _, cycle in library.cycles]
    assert loops == ["loops/anna/take.bvh/take_loop.bvh", "loops/ben/take.bvh/take_loop.bvh"]
    assert len({len(rl.read(library.folder / loop)) for loop in loops}) == 2
    apart = rl.build_library([clips / "anna", clips / "ben"], tmp_path / "other", jobs=1)
    assert [cycle["loop"] for _, cycle in apart.cycles] == loops


def written(library: rl.Library) -> dict[str, int]:
    return {
        cycle["loop"]: (library.folder / cycle["loop"]).stat().st_mtime_ns
        for _, cycle in library.cycles
    }


def test_only_what_is_new_or_changed_is_done(clips, tmp_path):
    folder = tmp_path / "library"
    library = rl.build_library(clips, folder, jobs=1)
    first = written(library)
    done: list[str] = []

    def told(fraction: float, stage: str) -> None:
        done.append(stage)

    same = rl.build_library(clips, folder, jobs=1, progress=told)
    assert (written(same), same.record) == (first, library.record)
    assert done == []
    write_gait(clips / "anna" / "take.bvh", "jacks", seed=5)
    write_gait(clips / "carl.bvh", "walk", seed=6)
    second = written(rl.build_library(clips, folder, jobs=1, progress=told))
    assert done == ["1 of 2 clips", "2 of 2 clips"]
    ben = "loops/ben/take.bvh/take_loop.bvh"
    assert second.keys() == first.keys() | {"loops/carl.bvh/carl_loop.bvh"}
    assert [loop for loop in first if first[loop] == second[loop]] == [ben]
    again = rl.build_library(clips, folder, jobs=1, again=True, progress=told)
    assert written(again)[ben] > second[ben]
    (folder / ben).unlink()
    with pytest.warns(rl.RoundelayWarning, match="loops are damaged or gone: 1$"):
        assert ben in written(rl.build_library(clips, folder, jobs=1))


def test_other_options_are_another_version(clips, tmp_path):
    first = rl.build_library(clips, tmp_path / "library", jobs=1)
    options = rl.LoopOptions(fps=30.0, in_place=True, file_format="glb")
    second = rl.build_library(clips, tmp_path / "library", options, jobs=1)
    assert [cycle["loop_frames"] for _, cycle in second.cycles] == [34, 23]
    files = {path.name for path in (first.folder / "loops").rglob("*") if path.is_file()}
    assert files == {"take_loop.glb"}


def test_a_packed_clip_is_a_clip(clips, tmp_path):
    plain = clips / "ben" / "take.bvh"
    plain.with_name("take.bvh.gz").write_bytes(gzip.compress(plain.read_bytes()))
    plain.unlink()
    library = rl.build_library(clips, tmp_path / "library", jobs=1)
    assert list(records(library)) == ["anna/take.bvh", "ben/take.bvh.gz"]
    (cycle,) = records(library)["ben/take.bvh.gz"]["cycles"]
    assert cycle["loop"] == "loops/ben/take.bvh.gz/take_loop.bvh"


def test_what_is_gone_is_no_longer_told_of(clips, tmp_path):
    rl.build_library(clips, tmp_path / "library", jobs=1)
    (clips / "ben" / "take.bvh").unlink()
    library = rl.build_library(clips, tmp_path / "library", jobs=1)
    assert list(records(library)) == ["anna/take.bvh"]


def test_cancelled_work_keeps_what_is_done(clips, tmp_path):
    folder = tmp_path / "library"
    with pytest.raises(rl.Cancelled):
        rl.build_library(clips, folder, jobs=1, progress=lambda fraction, stage: False)
    library = rl.Library.open(folder)
    assert list(records(library)) == ["anna/take.bvh"]
    assert library.summary["waiting"] == 1
    first = written(library)
    second = written(rl.build_library(clips, folder, jobs=1))
    assert first.items() < second.items()


def test_a_line_cut_short_costs_its_clip_only(clips, tmp_path):
    folder = tmp_path / "library"
    first = written(rl.build_library(clips, folder, jobs=1))
    log = folder / "clips.jsonl"
    text = log.read_text()
    log.write_text(text[: text.rindex('"record"') + 100])
    with pytest.warns(rl.RoundelayWarning, match="library: mended: damaged records: 1$"):
        again = rl.build_library(clips, folder, jobs=1)
    second = written(again)
    changed = [loop for loop in first if first[loop] != second[loop]]
    assert changed == ["loops/ben/take.bvh/take_loop.bvh"]


@pytest.mark.parametrize("place", [".", "library"])
def test_loops_within_the_source_are_not_read(clips, place):
    for again in (False, True):
        library = rl.build_library(clips, clips / place, jobs=1, again=again)
        assert library.summary["clips"] == 2


def test_sources_above_the_current_folder(clips, tmp_path, monkeypatch):
    monkeypatch.chdir(clips / "anna")
    for _ in range(2):
        library = rl.build_library(["../ben", ".", "take.bvh"], "library", jobs=1, again=True)
        assert [clip["file"] for clip in library.clips] == ["anna/take.bvh", "ben/take.bvh"]
        assert all((clips / "anna/library/loops" / file).is_dir() for file, _ in library.cycles)
        library = rl.build_library("..", "library", jobs=1, again=True)
        assert [clip["file"] for clip in library.clips] == ["anna/take.bvh", "ben/take.bvh"]


def test_names_that_are_no_text(clips, tmp_path):
    odd = os.fsdecode(b"caf\xe9.bvh")
    try:
        (clips / "ben").rename(clips / odd.removesuffix(".bvh"))
        (clips / "anna" / "take.bvh").rename(clips / odd)
    except OSError:
        pytest.skip("this file system has text for names only")
    library = rl.build_library(clips, tmp_path / "library", jobs=1)
    assert {file for file, _ in library.cycles} == {odd, f"{odd[:-4]}/take.bvh"}
    assert b"caf\xe9.bvh" in (library.folder / "cycles.csv").read_bytes()


def test_faults_of_the_program_do_not_end_the_work(clips, tmp_path, monkeypatch):
    def broken(motion, render, timeline):
        raise ZeroDivisionError("a fault")

    monkeypatch.setattr("roundelay.library.clips.make_loops", broken)
    library = rl.build_library(clips, tmp_path / "library", jobs=1)
    assert [clip["error"] for clip in library.clips] == [
        "anna/take.bvh: ZeroDivisionError: a fault",
        "ben/take.bvh: ZeroDivisionError: a fault",
    ]


def test_an_unreadable_folder_is_one_line(clips, tmp_path, monkeypatch):
    scandir = os.scandir

    def refusing(path):
        if Path(path).name == "ben":
            raise PermissionError(13, "Permission denied", str(path))
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refusing)
    refused: list[str] = []
    library = rl.build_library(clips, tmp_path / "library", jobs=1, refused=refused.append)
    assert refused == [f"{clips / 'ben'}: Permission denied"] == library.record["unread"]
    assert list(records(library)) == ["anna/take.bvh"]


def test_an_unreadable_file_is_tried_again(clips, tmp_path, monkeypatch):
    def refusing(path):
        raise PermissionError(13, "Permission denied", str(path))

    with monkeypatch.context() as patch:
        patch.setattr("roundelay.library.clips.read", refusing)
        library = rl.build_library(clips, tmp_path / "library", jobs=1)
    assert [clip["error"] for clip in library.clips] == [
        "anna/take.bvh: Permission denied",
        "ben/take.bvh: Permission denied",
    ]
    assert rl.build_library(clips, tmp_path / "library", jobs=1).summary["refused"] == 0


def test_bad_sources_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="found none"):
        rl.build_library(tmp_path, tmp_path / "library")
    with pytest.raises(FileNotFoundError):
        rl.build_library(tmp_path / "nowhere", tmp_path / "library")
    (tmp_path / "a.txt").write_text("")
    with pytest.raises(ValueError, match=r"found 'a.txt'"):
        rl.build_library(tmp_path / "a.txt", tmp_path / "library")
    with pytest.raises(ValueError, match="at least one job"):
        rl.build_library(tmp_path, tmp_path / "library", jobs=0)
    with pytest.raises(ValueError, match="expected fps as a number, more than 0"):
        rl.LoopOptions(fps=0.0)
    with pytest.raises(TypeError, match="expected a LoopOptions, found int"):
        rl.build_library(tmp_path, tmp_path / "library", 3)
    with pytest.raises(ValueError, match=r"expected a profile among .*, found 'arcade'"):
        rl.LoopOptions(profile="arcade")
    with pytest.raises(ValueError, match="found 'obj'"):
        rl.LoopOptions(file_format="obj")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_processes_find_what_one_finds(shared, made, tmp_path):
    library = rl.build_library(shared, tmp_path / "library", jobs=2)
    found, expected = (
        [(file, cycle["group"], cycle["parts"], cycle["loop"]) for file, cycle in one.cycles]
        for one in (library, made[0])
    )
    assert found == expected
    assert library.summary == made[0].summary
