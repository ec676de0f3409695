"""One version in all places: ``python -m release.versions set 1.2.0``, ``check [v1.2.0]``."""

from __future__ import annotations

import os
import re
import sys
import tomllib
from datetime import UTC, datetime
from pathlib import Path

__all__ = ["PLACES", "faults", "told", "written"]

ROOT = Path(__file__).resolve().parent.parent
# In each file, what stands before the version and after it.
PLACES = {
    "pyproject.toml": ('\nversion = "', '"'),
    "src/roundelay/base/version.py": ('__version__ = "', '"'),
    "blender/roundelay_extension/blender_manifest.toml": ('\nversion = "', '"'),
    "conda/recipe.yaml": ('  version: "', '"'),
    "CITATION.cff": ("\nversion: ", "\n"),
}
DATE = ("\ndate-released: ", "\n")
_FORM = re.compile(r"\d+\.\d+\.\d+")


def told(root: Path = ROOT) -> dict[str, str]:
    """Return the version that each place tells."""
    return {place: _found(_text(root, place), marks)[1] for place, marks in PLACES.items()}


def written(version: str, day: str, root: Path = ROOT) -> None:
    """Write a version to all places, and the day to `CITATION.cff`."""
    if not _FORM.fullmatch(version):
        raise SystemExit(f"expected a version such as 1.2.0, found {version!r}")
    for place, marks in PLACES.items():
        text = _changed(_text(root, place), marks, version)
        if place == "CITATION.cff":
            text = _changed(text, DATE, day)
        (root / place).write_text(text, encoding="utf-8")


def faults(tag: str | None = None, root: Path = ROOT) -> list[str]:
    """Say where versions differ; with a tag, also what a release still lacks."""
    version = told(root)["pyproject.toml"]
    wrong = [
        f"expected {version} in {place}, found {other}"
        for place, other in told(root).items()
        if other != version
    ]
    return wrong if tag is None else wrong + _faults_of_release(tag, version, root)


def _faults_of_release(tag: str, version: str, root: Path) -> list[str]:
    wrong = [] if tag == f"v{version}" else [f"expected the tag v{version}, found {tag}"]
    day = _found(_text(root, "CITATION.cff"), DATE)[1]
    if f"## {version} ({day})" not in _text(root, "CHANGELOG.md"):
        wrong.append(f"expected {version} of {day} in CHANGELOG.md, found none: make release")
    wrong += [
        f"expected no change notes left, found {path.name}: make release"
        for path in sorted((root / "changes").glob("*.change.md"))
    ]
    source = tomllib.loads(_text(root, "pyproject.toml"))["project"]["urls"]["Source"]
    here = f"{os.environ.get('GITHUB_SERVER_URL')}/{os.environ.get('GITHUB_REPOSITORY')}"
    if "GITHUB_REPOSITORY" in os.environ and source != here:
        wrong.append(f"expected {here} as the URL of the source in pyproject.toml, found {source}")
    return wrong


def _text(root: Path, place: str) -> str:
    return (root / place).read_text(encoding="utf-8")


def _found(text: str, marks: tuple[str, str]) -> tuple[int, str]:
    """Return where the words between two marks begin, and the words."""
    before, after = marks
    start = text.index(before) + len(before)
    return start, text[start : text.index(after, start)]


def _changed(text: str, marks: tuple[str, str], words: str) -> str:
    start, old = _found(text, marks)
    return text[:start] + words + text[start + len(old) :]


def main(action: str, *words: str) -> None:
    """Set or check."""
    if action == "set" and len(words) == 1:
        written(words[0], datetime.now(UTC).strftime("%Y-%m-%d"))
    elif action == "check" and len(words) <= 1:
        if wrong := faults(*words):
            sys.exit("\n".join(wrong))
        print(f"one version in {len(PLACES)} places: {told()['pyproject.toml']}")
    else:
        sys.exit(f"expected set VERSION or check [TAG], found {action} {' '.join(words)}".rstrip())


if __name__ == "__main__":
    main(*(sys.argv[1:] or [""]))
