"""Set loops up in Unreal, from the record that was written beside them.

In the editor, with the plug-in "Python Editor Script Plugin"::

    import roundelay_import
    roundelay_import.import_loops("C:/loops/Walk_loop.json", "/Game/Loops")

for what ``roundelay loop Walk.bvh --for unreal`` made: each file is imported as a skeletal mesh
with its animation, root motion is switched on where the file has it, and each event becomes a
sync marker. Unreal repeats a sequence where it is played: tick *Loop* in the player of an animation
blueprint, or play it with ``looping=True``.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import unreal

TRACK = "roundelay"


def import_loops(record: str, folder: str) -> list[Any]:
    """Import all loops of a record and set them up.

    Parameters
    ----------
    record : str
        A ``NAME_loop.json``, or what ``-o`` named.
    folder : str
        Where assets go, such as ``/Game/Loops``.

    Returns
    -------
    list of unreal.AnimSequence
    """
    told = json.loads(Path(record).read_text(encoding="utf-8"))
    made = []
    for cycle in told["cycles"]:
        file = Path(record).parent / cycle["files"][0]
        for sequence in _imported(file, folder):
            set_up(sequence, cycle["playback"])
            made.append(sequence)
    return made


def set_up(sequence: Any, playback: dict[str, Any]) -> None:
    """Set root motion and events of a sequence and save it."""
    moves = playback["root_motion"]["in_file"] and playback["root_bone"] is not None
    library = unreal.AnimationLibrary
    library.set_root_motion_enabled(sequence, moves)
    library.set_root_motion_lock_type(sequence, unreal.RootMotionRootLock.ANIM_FIRST_FRAME)
    if library.is_valid_anim_notify_track_name(sequence, TRACK):
        library.remove_animation_notify_track(sequence, TRACK)
    library.add_animation_notify_track(sequence, TRACK)
    # Events are of one period; the sequence may hold several.
    for start in range(0, playback["frames"], playback["frames_per_period"]):
        for event in playback["events"]:
            seconds = event["seconds"] + start / playback["fps"]
            library.add_animation_sync_marker(sequence, event["name"], seconds, TRACK)
    unreal.EditorAssetLibrary.save_loaded_asset(sequence)


def _imported(file: Path, folder: str) -> list[Any]:
    options = unreal.FbxImportUI()
    options.set_editor_property("import_mesh", True)
    options.set_editor_property("import_as_skeletal", True)
    options.set_editor_property("import_animations", True)
    options.set_editor_property("mesh_type_to_import", unreal.FBXImportType.FBXIT_SKELETAL_MESH)
    task = unreal.AssetImportTask()
    task.set_editor_property("filename", str(file))
    task.set_editor_property("destination_path", folder)
    task.set_editor_property("automated", True)
    task.set_editor_property("replace_existing", True)
    task.set_editor_property("save", True)
    task.set_editor_property("options", options)
    unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks([task])
    paths = task.get_editor_property("imported_object_paths")
    assets = [unreal.EditorAssetLibrary.load_asset(path) for path in paths]
    return [asset for asset in assets if isinstance(asset, unreal.AnimSequence)]
