"""The kept corpus: files that once failed, or that show a corner of a format."""

from __future__ import annotations

from pathlib import Path

from tests.fuzz.chance import Files

from roundelay.formats import readers, suffixes_of

__all__ = ["FOLDER", "captures", "kept"]

FOLDER = Path(__file__).parent / "corpus"


def captures() -> list[Path]:
    """List the captures of the corpus."""
    return [path for path in sorted(FOLDER.iterdir()) if path.suffix in suffixes_of(readers)]


def kept() -> list[Files]:
    """Return the files of each capture of the corpus: an AMC has its ASF, of the same name."""
    return [files_of(path) for path in captures()]


def files_of(path: Path) -> Files:
    """Return the files of a capture by their suffixes."""
    parts = [path, *([path.with_suffix(".asf")] if path.suffix == ".amc" else [])]
    return {f"a{part.suffix}": part.read_bytes() for part in parts}
