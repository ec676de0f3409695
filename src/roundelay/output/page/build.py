"""Build the page of a capture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from roundelay.base.errors import NoPeriod
from roundelay.base.texts import shown
from roundelay.base.threads import one_thread
from roundelay.base.version import __version__
from roundelay.loops.recipe import Loop
from roundelay.motion.motion import Motion
from roundelay.output.figures.palette import phase_colours
from roundelay.output.figures.space import Space
from roundelay.output.page.bundle import bundle
from roundelay.output.page.capture import capture_data
from roundelay.output.page.findings import loop_data, refusal_data
from roundelay.output.page.packing import Packer
from roundelay.segmentation.result import Segmentation

__all__ = ["build_page"]


@one_thread
def build_page(
    motion: Motion,
    loops: Sequence[Loop] = (),
    *,
    refusal: NoPeriod | None = None,
    segmentation: Segmentation | None = None,
) -> str:
    """Return a self-contained HTML page of a capture.

    Parameters
    ----------
    motion : Motion
        The capture.
    loops : sequence of Loop
        What `roundelay.make_loops` made of it.
    refusal : NoPeriod, optional
        Why it found none; the page then shows the capture, the reason and the evidence.
    segmentation : Segmentation, optional
        The capture's behaviours, for the timeline.

    Returns
    -------
    str
        HTML that makes no outside request.
    """
    packer, space = Packer(), Space.of(motion)
    document: dict[str, Any] = {
        "name": shown(motion.name) or "capture",
        "version": __version__,
        "colours": phase_colours(64),
        "segments": [] if segmentation is None else _segments(segmentation),
        "capture": capture_data(motion, space, packer),
        "reason": "" if refusal is None else str(refusal),
    }
    if refusal is not None:
        document["motions"] = refusal_data(motion, refusal, packer)
    else:
        document["motions"] = [
            loop_data(motion, loop, space, packer, file=_file_name(shown(motion.name), number))
            for number, loop in enumerate(loops, 1)
        ]
    return bundle(document["name"], packer.text(document))


def _segments(segmentation: Segmentation) -> list[tuple[int, int, int]]:
    """List start, stop and label; nothing if the capture is one behaviour."""
    found = [(part.start, part.stop, part.label) for part in segmentation.segments]
    return found if len(found) > 1 else []


def _file_name(name: str, number: int) -> str:
    """Name a loop as ``roundelay loop`` does."""
    return f"{name or 'capture'}_loop{number if number > 1 else ''}.bvh"
