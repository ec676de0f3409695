"""``roundelay retarget``: a motion or a loop on another character."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Output,
    Skeleton,
    echo,
    in_format_of,
    one_line_errors,
    place_of,
    read_capture,
    refuse_over,
)
from roundelay.commands.options import only, takes
from roundelay.formats.options import ReadOptions
from roundelay.loops.options import LoopOptions
from roundelay.retargeting.options import OntoOptions

if TYPE_CHECKING:
    from roundelay.retargeting.mapping import BodyMap

__all__ = ["retarget"]


@takes(carrying=OntoOptions, written=only(LoopOptions, "file_format"), reading=ReadOptions)
def retarget(
    capture: Capture,
    output: Output = ".",
    skeleton: Skeleton = None,
    *,
    carrying: OntoOptions,
    written: LoopOptions,
    reading: ReadOptions,
    given: frozenset[str],
) -> None:
    """Carry a motion or a loop to another character, whatever its names, bones and pose at rest.

    Writes NAME_onto.glb for a character with meshes, else NAME_onto.bvh, or names as -o says; and
    NAME_onto_map.json, which joints were taken for which, unless --map names a file. A loop stays
    one. Feet stand where they stood, and hands that touch the body touch it again.
    """
    with one_line_errors(capture):
        from roundelay.formats import suffixes_of, wraps_at_last_key, write, writers
        from roundelay.retargeting.characters import to_character
        from roundelay.retargeting.mapping import write_maps
        from roundelay.retargeting.onto import as_played

        if carrying.onto is None:
            raise ValueError("expected a character (--onto FILE), found none")
        place = place_of(output, name_of(capture), suffixes_of(writers))
        refuse_over(capture, place)
        motion = read_capture(capture, skeleton, reading)
        to = to_character(motion, carrying)
        motion = to(motion)
        if place.file is None and not given & {"format"}:
            meshes = motion.skeleton.figure is not None
            written = replace(written, file_format="glb" if meshes else "bvh")
        else:
            written = in_format_of(place, written, given, capture, reading)
        path = place.path("onto", f".{written.file_format}")
        motion = as_played(motion, wraps_at_last_key(written.file_format or "bvh"))
        write(motion, path)
        if carrying.map is None:
            write_maps(to.maps, path.with_name(f"{path.stem}_map.json"))
        echo(f"{shown(path)}: {len(motion)} frames at {motion.fps:.4g} fps")
        for name, body in to.maps.items():
            echo(f"  {name}: {_told(body)}")


def _told(body: BodyMap) -> str:
    known = len(body.joints)
    missing = f"; without {', '.join(body.missing)}" if body.missing else ""
    return f"a {body.kind}, {known} of {known + len(body.missing)} joints found{missing}"
