"""One version stands in all places, and a release says what it still lacks."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from release import versions

import roundelay

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the places that tell a version."""
    for place in (*versions.PLACES, "CHANGELOG.md"):
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / place, tmp_path / place)
    return tmp_path


def test_all_places_tell_one_version() -> None:
    assert versions.faults() == []
    assert versions.told()["pyproject.toml"] == roundelay.__version__


def test_a_version_is_written_to_all_places_and_nothing_else(tree: Path) -> None:
    before = {place: (tree / place).read_text() for place in versions.PLACES}
    old = versions.told(tree)["pyproject.toml"]
    versions.written("12.3.4", "2031-02-03", tree)
    assert set(versions.told(tree).values()) == {"12.3.4"}
    for place, text in before.items():
        after = (tree / place).read_text().replace("12.3.4", old)
        assert re.sub(r"released: \S+", "", after) == re.sub(r"released: \S+", "", text)
    assert "date-released: 2031-02-03\n" in (tree / "CITATION.cff").read_text()


def test_a_place_that_differs_is_named(tree: Path) -> None:
    place = tree / "CITATION.cff"
    place.write_text(place.read_text().replace("\nversion: ", "\nversion: 9"))
    assert len(versions.faults(root=tree)) == 1
    assert "in CITATION.cff, found 9" in versions.faults(root=tree)[0]


def test_a_release_says_what_it_lacks(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("GITHUB_REPOSITORY", raising=False)
    versions.written("2.0.0", "2031-02-03", tree)
    (tree / "changes").mkdir()
    (tree / "changes" / "+new.change.md").touch()
    tag, notes, left = versions.faults("v2.0.1", tree)
    assert tag == "expected the tag v2.0.0, found v2.0.1"
    assert "expected 2.0.0 of 2031-02-03 in CHANGELOG.md" in notes
    assert "expected no change notes left, found +new.change.md" in left
    (tree / "changes" / "+new.change.md").unlink()
    (tree / "CHANGELOG.md").write_text("## 2.0.0 (2031-02-03)\n")
    assert versions.faults("v2.0.0", tree) == []
    monkeypatch.setenv("GITHUB_REPOSITORY", "someone/else")
    assert "as the URL of the source" in versions.faults("v2.0.0", tree)[0]


def test_a_word_that_is_no_version_is_refused(tree: Path) -> None:
    with pytest.raises(SystemExit, match=r"expected a version such as 1\.2\.0, found 'v1'"):
        versions.written("v1", "2031-02-03", tree)
