"""Documentation of every released version, each in a folder, with a list to switch by.

Usage: python -m release.documents [--out out/versions]

Each tag v1.2.0 is checked out beside and builds its own documentation by its own ``make docs``;
the working tree's is the newest. What is there already is not built again. ``versions.json`` lists
them, newest first, and the pages' sidebar switches by it.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import tempfile
from pathlib import Path

from roundelay.base.version import __version__

ROOT = Path(__file__).resolve().parent.parent


def main() -> None:
    """Build what is not there, and list it."""
    asked = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    asked.add_argument("--out", type=Path, default=ROOT / "out" / "versions")
    out = asked.parse_args().out
    names = [__version__]
    shutil.rmtree(out / __version__, ignore_errors=True)
    build(ROOT, out / __version__)
    for tag in tags():
        name = tag.removeprefix("v")
        if name == __version__:
            continue
        names.append(name)
        if not (out / name).is_dir():
            build_tag(tag, out / name)
    (out / "versions.json").write_text(json.dumps(names) + "\n")
    (out / "index.html").write_text(
        f'<!doctype html><meta http-equiv="refresh" content="0; url={names[0]}/index.html">\n'
    )


def tags() -> list[str]:
    """List the tags of released versions, newest first."""
    listed = ["git", "tag", "--list", "v*", "--sort=-version:refname"]
    return subprocess.run(
        listed, cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()


def build_tag(tag: str, place: Path) -> None:
    """Build the documentation of a tag in a working tree beside."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / tag
        subprocess.run(["git", "worktree", "add", "--detach", tree, tag], cwd=ROOT, check=True)
        try:
            build(tree, place)
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", tree], cwd=ROOT, check=True)


def build(tree: Path, place: Path) -> None:
    """Build a tree's documentation by its Makefile, and put it in its place."""
    subprocess.run(["make", "docs"], cwd=tree, check=True)
    place.parent.mkdir(parents=True, exist_ok=True)
    shutil.copytree(tree / "out" / "docs", place)


if __name__ == "__main__":
    main()
