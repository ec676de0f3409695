"""One page of a library: its groups with moving figures, their names, counts, what was refused."""

from __future__ import annotations

import base64
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from roundelay.base.files import written_beside
from roundelay.base.texts import shown
from roundelay.compare.packed import Packed, pair_distances, unpacked
from roundelay.compare.person import BONES, POINTS
from roundelay.compare.spectra import Spectra
from roundelay.compare.thresholds import SPECTRA
from roundelay.library.catalogue import Library

__all__ = ["write_report"]

Row = dict[str, Any]
# A person's left is the third axis.
_ACROSS = np.array([1.0, 1.0, -1.0], np.float32)
# Thousandths of a body tell a figure's place.
_UNIT = 1000
_TEMPLATE = Path(__file__).with_name("report.html")


def write_report(library: Library, path: Path) -> None:
    """Write one page of a library that needs nothing else.

    Parameters
    ----------
    library : Library
    path : Path

    Raises
    ------
    OSError
        If it cannot be written.
    """
    told = {
        "summary": library.summary,
        "points": POINTS,
        "bones": [[POINTS.index(a), POINTS.index(b)] for a, b in BONES],
        "harmonics": SPECTRA.harmonics,
        "unit": 1 / _UNIT,
        "groups": list(_groups(library)),
        "refused": [_refused(clip) for clip in library.clips if clip["error"] is not None],
    }
    # Within a page no text may begin a tag.
    text = json.dumps(told, allow_nan=False).replace("<", "\\u003c")
    page = _TEMPLATE.read_text(encoding="utf-8").replace("@DATA@", text)
    with written_beside(path) as part:
        part.write_text(page, encoding="utf-8")


def _refused(clip: Row) -> tuple[str, str]:
    return shown(clip["file"]), shown(clip["error"].removeprefix(f"{clip['file']}:").strip())


def _groups(library: Library) -> Iterator[Row]:
    """Tell of each group what its card shows."""
    members: dict[int, list[int]] = {}
    for number, (_, record) in enumerate(library.behaviours):
        members.setdefault(record["group"], []).append(number)
    homes = _homes(library)
    for group in library.record["groups"]:
        inside = members[group["group"]]
        shelf, rows = homes[inside[0]][0], [homes[number][1] for number in inside]
        packed = library.shelves[shelf].packed
        order = _by_typicality(packed, rows)
        kept = ("group", "name", "named_by", "behaviours", "clips", "period_seconds")
        told = {name: group[name] for name in kept} | _told(library, [inside[k] for k in order])
        if packed.body.joints == POINTS:
            told["figure"] = _figure(packed[np.array([rows[order[0]]])])
        yield told


def _homes(library: Library) -> dict[int, tuple[int, int]]:
    """Return the shelf and the row of every behaviour, by its number."""
    return {
        number: (shelf, row)
        for shelf, one in enumerate(library.shelves)
        for row, number in enumerate(one.numbers.tolist())
    }


def _by_typicality(packed: Packed, rows: Sequence[int]) -> list[int]:
    """Return places in the order of their distance to the one nearest to the mean vector."""
    own = np.array(rows)
    vectors = packed[own].vectors()
    first = int(np.argmin(np.sum((vectors - vectors.mean(axis=0)) ** 2, axis=1)))
    apart = pair_distances(packed, packed, own, np.full(len(own), own[first]))
    return np.argsort(apart, kind="stable").tolist()


def _told(library: Library, numbers: Sequence[int]) -> Row:
    """Tell of the behaviours of a group, the most typical first."""
    found = [library.behaviours[number] for number in numbers]
    verdicts = Counter(one["verdict"]["word"] for _, one in found if "verdict" in one)
    return {
        "verdicts": dict(verdicts),
        "files": sorted({shown(file) for file, _ in found}),
        "most": _place(*found[0]),
        "least": _place(*found[-1]),
        "lasts": _lasts(library, *found[0]),
    }


def _place(file: str, record: Row) -> str:
    parts = record.get("parts") or [[record["start_frame"], record["end_frame"]]]
    return f"{shown(file)}, frames {parts[0][0]}-{parts[0][1]}"


def _lasts(library: Library, file: str, record: Row) -> float:
    """Return the seconds of a cycle; what is done once is shown there and back."""
    if "period_seconds" in record:
        return float(record["period_seconds"])
    (fps,) = [clip["fps"] for clip in library.clips if clip["file"] == file]
    return 2.0 * max(1, record["end_frame"] - record["start_frame"]) / fps


def _figure(packed: Packed) -> str:
    """Return means and harmonics of a person's points as text."""
    spectra: Spectra = unpacked(packed, _ACROSS)
    waves = spectra.waves[0]
    parts = [spectra.means[0], *(part for wave in waves for part in (wave.real, wave.imag))]
    numbers = np.clip(np.round(_UNIT * np.array(parts)), -32768, 32767).astype("<i2")
    return base64.b64encode(numbers.tobytes()).decode()
