"""Carry what is read to the character of a file, by a map that is found, read and kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.formats import read_character
from roundelay.motion.motion import Motion
from roundelay.retargeting.mapping import read_maps, write_maps
from roundelay.retargeting.onto import Retargeting
from roundelay.retargeting.options import OntoOptions

__all__ = ["carried_cycles", "to_character"]


@one_thread
def to_character(motion: Motion, chosen: OntoOptions) -> Retargeting:
    """Prepare what carries a motion to the character that the options name.

    Parameters
    ----------
    motion : Motion
    chosen : OntoOptions
        With a character. What is found of which joints are which is written to its map, if there
        is no such file.

    Raises
    ------
    SkeletonMismatch
        If the bodies do not correspond; see `roundelay.retarget`.
    FormatError
        If the character or the map cannot be read.
    OSError
        If a file cannot be read, or the map not written.
    """
    told = {} if chosen.map is None or not Path(chosen.map).exists() else read_maps(chosen.map)
    character = read_character(chosen.onto or "", character=chosen.onto_root)
    carrying = Retargeting.between(
        motion, character, source_map=told.get("capture"), target_map=told.get("character")
    )
    if chosen.map is not None and not told:
        write_maps(carrying.maps, chosen.map)
    return carrying


@one_thread
def carried_cycles(
    cycles: Sequence[Cycle], motion: Motion, carrying: Retargeting
) -> tuple[list[Cycle], Motion]:
    """Carry cycles and the capture that they were found in.

    Parameters
    ----------
    cycles : sequence of Cycle
    motion : Motion
    carrying : Retargeting

    Returns
    -------
    cycles : list of Cycle
        With the evidence that they were found by.
    motion : Motion
    """
    carried = [
        replace(carrying.cycle(one), evidence=one.evidence, phase=one.phase, method=one.method)
        for one in cycles
    ]
    return carried, carrying(motion)
