"""Inside Blender: make files of one body by the exporters' options, and tell what is imported.

Usage: python scenes.py make FOLDER | python scenes.py poses LIST.json
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Vector

FINGERS = ("Thumb", "Index", "Middle", "Ring", "Pinky")
FRAMES, PERIOD = 97, 24
# Poses that are compared.
POSES = 20


def bones() -> dict[str, tuple[str, tuple[float, float, float]]]:
    """List 65 bones as Mixamo names them: parent, and place of the head in metres."""
    found = {"Hips": ("", (0, 0, 1.0))}
    chain = [("Spine", 1.1), ("Spine1", 1.22), ("Spine2", 1.35), ("Neck", 1.5), ("Head", 1.58)]
    above = "Hips"
    for name, height in [*chain, ("HeadTop_End", 1.78)]:
        found[name] = (above, (0, 0, height))
        above = name
    for side, sign in (("Left", 1), ("Right", -1)):
        _limb(found, side, sign)
    return found


def _limb(found: dict, side: str, sign: int) -> None:
    arm = [("Shoulder", 0.05), ("Arm", 0.18), ("ForeArm", 0.45), ("Hand", 0.7)]
    above = "Spine2"
    for name, out in arm:
        found[side + name] = (above, (sign * out, 0, 1.45))
        above = side + name
    for number, finger in enumerate(FINGERS):
        above = f"{side}Hand"
        for joint in range(1, 5):
            place = (sign * (0.72 + 0.03 * joint), 0.02 * (number - 2), 1.45)
            found[f"{side}Hand{finger}{joint}"] = (above, place)
            above = f"{side}Hand{finger}{joint}"
    leg = [("UpLeg", 0, 0.95), ("Leg", 0.01, 0.52), ("Foot", 0, 0.1)]
    above = "Hips"
    for name, ahead, height in [*leg, ("ToeBase", -0.12, 0.03), ("Toe_End", -0.2, 0.03)]:
        found[side + name] = (above, (sign * 0.1, ahead, height))
        above = side + name


def emptied(fps: int = 24) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = fps


def body(prefix: str = "mixamorig:", rolled: bool = False) -> bpy.types.Object:
    """Make the armature and a mesh on it."""
    data = bpy.data.armatures.new("Armature")
    rig = bpy.data.objects.new("Armature", data)
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    listed = bones()
    for number, (name, (parent, head)) in enumerate(listed.items()):
        bone = data.edit_bones.new(prefix + name)
        tails = [place for above, place in listed.values() if above == name]
        bone.head = head
        bone.tail = Vector(tails[0]) if tails else Vector(head) + Vector((0, -0.05, 0.05))
        bone.roll = 0.3 * (number % 5) if rolled else 0.0
        if parent:
            bone.parent = data.edit_bones[prefix + parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    _mesh(rig, listed, prefix)
    return rig


def _mesh(rig: bpy.types.Object, listed: dict, prefix: str) -> None:
    """Hang a box on every bone, in one mesh of two materials."""
    corners, faces, groups = [], [], {}
    for name, (_, head) in listed.items():
        tails = [place for above, place in listed.values() if above == name]
        first, last = Vector(head), Vector(tails[0] if tails else head)
        wide = 0.012 if "Hand" in name and name[-1].isdigit() else 0.06
        along = (last - first) or Vector((0, 0, 0.05))
        across = along.orthogonal().normalized() * wide
        other = along.cross(across).normalized() * wide
        base = len(corners)
        for end in (first, first + along):
            corners += [end + across, end + other, end - across, end - other]
        sides = [
            (base + k, base + (k + 1) % 4, base + 4 + (k + 1) % 4, base + 4 + k) for k in range(4)
        ]
        faces += [
            *sides,
            tuple(base + k for k in (3, 2, 1, 0)),
            tuple(base + k for k in (4, 5, 6, 7)),
        ]
        groups[name] = list(range(base, base + 8))
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(corners, [], faces)
    mesh.uv_layers.new(name="UVMap")
    for name, colour in (("Skin", (0.8, 0.5, 0.3, 1)), ("Cloth", (0.2, 0.3, 0.7, 1))):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = colour
        material.diffuse_color = colour
        mesh.materials.append(material)
    for number, face in enumerate(mesh.polygons):
        face.material_index = number // 6 % 2
    shown = bpy.data.objects.new("Body", mesh)
    bpy.context.collection.objects.link(shown)
    for name, members in groups.items():
        shown.vertex_groups.new(name=prefix + name).add(members, 1.0, "REPLACE")
    shown.parent = rig
    shown.modifiers.new("Armature", "ARMATURE").object = rig


def walk(
    rig: bpy.types.Object,
    name: str = "walk",
    every: int = 1,
    mode: str = "QUATERNION",
    curve: str = "LINEAR",
    speed: float = 1.0,
    stretch: bool = False,
    first: int = 1,
) -> None:
    """Key a walk on the bones."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = first, first + FRAMES - 1
    rig.animation_data_create()
    rig.animation_data.action = bpy.data.actions.new(name)
    for bone in rig.pose.bones:
        bone.rotation_mode = mode
    for frame in range(0, FRAMES, every):
        phase = 2 * math.pi * frame / PERIOD * speed
        for bone in rig.pose.bones:
            _posed(bone, phase, frame, first + frame)
        if stretch:
            thigh = next(b for b in rig.pose.bones if b.name.endswith("LeftUpLeg"))
            thigh.location = (0, 0.02 * math.sin(phase), 0)
            thigh.keyframe_insert("location", frame=first + frame)
    for one in _curves(rig.animation_data.action):
        for point in one.keyframe_points:
            point.interpolation = curve


def _posed(bone: bpy.types.PoseBone, phase: float, frame: int, at: int) -> None:
    name = bone.name.rpartition(":")[2]
    sign = 1 if name.startswith("Left") else -1
    swing = {
        "UpLeg": (0.5 * sign, 0.0),
        "Leg": (0.4, 1.0 + sign),
        "Foot": (0.25 * sign, 0.5),
        "Arm": (-0.4 * sign, 0.2),
        "ForeArm": (0.3, 0.4 * sign),
        "Spine1": (0.08, 0.3),
        "Head": (0.06, 0.9),
    }.get(name.removeprefix("Left").removeprefix("Right"), (0.03, 0.1 * len(name)))
    size, late = swing
    turn = Euler(
        (size * math.sin(phase + late), 0.3 * size * math.cos(phase), 0.2 * size * math.sin(phase)),
        "XYZ",
    )
    if bone.rotation_mode == "QUATERNION":
        bone.rotation_quaternion = turn.to_quaternion()
        bone.keyframe_insert("rotation_quaternion", frame=at)
    else:
        bone.rotation_euler = turn.to_quaternion().to_euler(bone.rotation_mode)
        bone.keyframe_insert("rotation_euler", frame=at)
    if name == "Hips":
        bone.location = (0.02 * math.sin(phase), 0.03 * math.cos(2 * phase), 0.05 * frame)
        bone.keyframe_insert("location", frame=at)


def _curves(action: bpy.types.Action) -> list:
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    return [
        curve
        for layer in action.layers
        for strip in layer.strips
        for bag in strip.channelbags
        for curve in bag.fcurves
    ]


def _placed(rig: bpy.types.Object) -> None:
    rig.location, rig.rotation_euler, rig.scale = (1, 2, 0.5), (0.1, 0.2, 0.7), (0.8, 0.8, 0.8)


def _moved(rig: bpy.types.Object) -> None:
    """Let the armature object move, too: the hips walk below it."""
    walk(rig)
    for frame in range(1, FRAMES + 1, 8):
        rig.location, rig.rotation_euler = (0.1 * frame, 0, 0), (0, 0, 0.01 * frame)
        rig.keyframe_insert("location", frame=frame)
        rig.keyframe_insert("rotation_euler", frame=frame)


def _two(rig: bpy.types.Object) -> None:
    """Two actions, both on tracks, so that each becomes an animation."""
    walk(rig, "run", speed=2.0)
    track = rig.animation_data.nla_tracks.new()
    track.strips.new("run", 1, rig.animation_data.action)
    walk(rig, "walk")


# What is exported: how the rig is made, how it moves, and the exporter's options.
FBX = {
    "default": ({}, {}, {}),
    "no_leaf_bones": ({}, {}, {"add_leaf_bones": False}),
    "space_baked": ({}, {}, {"bake_space_transform": True}),
    "z_up": ({}, {}, {"axis_up": "Z", "axis_forward": "Y"}),
    "z_up_unreal": ({}, {}, {"axis_up": "Z", "axis_forward": "-X"}),
    "x_up": ({}, {}, {"axis_up": "X", "axis_forward": "Z"}),
    "bones_along_x": ({}, {}, {"primary_bone_axis": "X", "secondary_bone_axis": "Y"}),
    "bones_along_minus_z": ({}, {}, {"primary_bone_axis": "-Z", "secondary_bone_axis": "X"}),
    "scale_units": ({}, {}, {"apply_scale_options": "FBX_SCALE_UNITS"}),
    "scale_custom": ({}, {}, {"apply_scale_options": "FBX_SCALE_CUSTOM", "global_scale": 3.0}),
    "scale_all": ({}, {}, {"apply_scale_options": "FBX_SCALE_ALL", "global_scale": 0.1}),
    "no_unit_scale": ({}, {}, {"apply_unit_scale": False, "global_scale": 0.5}),
    "every_second_frame": ({}, {}, {"bake_anim_step": 2.0}),
    "not_simplified": ({}, {}, {"bake_anim_simplify_factor": 0.0}),
    "much_simplified": ({}, {}, {"bake_anim_simplify_factor": 10.0}),
    "no_ends_keyed": ({}, {}, {"bake_anim_force_startend_keying": False}),
    "armature_root": ({}, {}, {"armature_nodetype": "ROOT"}),
    "armature_limb": ({}, {}, {"armature_nodetype": "LIMBNODE"}),
    "armature_alone": ({}, {}, {"object_types": {"ARMATURE"}}),
    "all_bones_keyed": ({}, {}, {"bake_anim_use_all_bones": True}),
    "rolled_bones": ({"rolled": True}, {}, {}),
    "euler_keys": ({}, {"mode": "ZXY", "every": 6, "curve": "BEZIER"}, {}),
    "placed": ({"then": _placed}, {}, {}),
    "moved": ({"moves": _moved}, {}, {}),
    "two_takes": ({"moves": _two}, {}, {}),
    "sixty": ({"fps": 60}, {}, {}),
    "stretching": ({}, {"stretch": True}, {}),
    "late": ({}, {"first": 50}, {}),
}
GLB = {
    "default": ({}, {}, {}),
    "separate": ({}, {}, {"export_format": "GLTF_SEPARATE"}),
    "not_y_up": ({}, {}, {"export_yup": False}),
    "not_sampled": ({}, {"every": 6, "curve": "LINEAR"}, {"export_force_sampling": False}),
    "cubic": ({}, {"every": 6, "curve": "BEZIER"}, {"export_force_sampling": False}),
    "step": ({}, {"every": 6, "curve": "CONSTANT"}, {"export_force_sampling": False}),
    "every_second_frame": ({}, {}, {"export_frame_step": 2}),
    "not_optimised": ({}, {}, {"export_optimize_animation_size": False}),
    "kept_keys": ({}, {}, {"export_optimize_animation_keep_anim_armature": False}),
    "flat_bones": ({}, {}, {"export_hierarchy_flatten_bones": True}),
    "no_armature_object": ({}, {}, {"export_armature_object_remove": True}),
    "deforming_bones": ({}, {}, {"export_def_bones": True}),
    "active_actions": ({"moves": _two}, {}, {"export_animation_mode": "ACTIVE_ACTIONS"}),
    "nla": ({"moves": _two}, {}, {"export_animation_mode": "NLA_TRACKS"}),
    "scene": ({}, {}, {"export_animation_mode": "SCENE"}),
    "two_actions": ({"moves": _two}, {}, {}),
    "current_rest": ({}, {}, {"export_rest_position_armature": False}),
    "draco": ({}, {}, {"export_draco_mesh_compression_enable": True}),
    "more_influences": ({}, {}, {"export_all_influences": True}),
    "rolled_bones": ({"rolled": True}, {}, {}),
    "placed": ({"then": _placed}, {}, {}),
    "moved": ({"moves": _moved}, {}, {}),
    "sixty": ({"fps": 60}, {}, {}),
    "stretching": ({}, {"stretch": True}, {}),
    "late": ({}, {"first": 50}, {}),
    "armature_alone": ({"alone": True}, {}, {"use_selection": True}),
}


def made(how: dict, moving: dict) -> None:
    emptied(how.get("fps", 24))
    rig = body(rolled=how.get("rolled", False))
    how.get("then", lambda rig: None)(rig)
    if "moves" in how:
        how["moves"](rig)
    else:
        walk(rig, **moving)
    if how.get("alone"):
        bpy.ops.object.select_all(action="DESELECT")
        rig.select_set(True)


def make(folder: Path) -> None:
    """Write a file of every row; what an exporter refuses is told."""
    version = bpy.app.version_string
    for kind, rows in (("fbx", FBX), ("glb", GLB)):
        for name, (how, moving, options) in rows.items():
            made(how, moving)
            path = folder / f"{name}_{version}.{kind}"
            try:
                if kind == "fbx":
                    options = {"bake_anim": True} | options
                    bpy.ops.export_scene.fbx(filepath=str(path), **options)
                else:
                    options = {"export_format": "GLB"} | options
                    bpy.ops.export_scene.gltf(filepath=str(path), **options)
            except (RuntimeError, TypeError) as error:
                print(json.dumps({"file": path.name, "error": str(error)}))


def poses(listed: Path) -> None:
    """Import files and tell where every bone is in some keyed frames."""
    for job in json.loads(listed.read_text()):
        emptied(job["fps"])
        path = Path(job["file"])
        try:
            if job["importer"] == "new":
                bpy.ops.wm.fbx_import(filepath=str(path))
            elif path.suffix == ".fbx":
                bpy.ops.import_scene.fbx(filepath=str(path))
            else:
                bpy.ops.import_scene.gltf(filepath=str(path))
            np.savez(job["out"], **_dumped(job))
        except Exception as error:
            print(json.dumps({"file": path.name, "error": str(error)[-300:]}), flush=True)


def _dumped(job: dict) -> dict:
    scene = bpy.context.scene
    rigs = [one for one in scene.objects if one.type == "ARMATURE"]
    rig = max(rigs, key=lambda one: len(one.pose.bones))
    action = _chosen(rig, job["animation"])
    keys = _keyed(action)
    own = rig.animation_data is not None and rig.animation_data.action is not None
    if own:
        rig.animation_data.action = action
    chosen = keys[np.unique(np.linspace(0, len(keys) - 1, POSES).astype(int))]
    places, turns = [], []
    for frame in chosen:
        scene.frame_set(int(np.floor(frame)), subframe=float(frame - np.floor(frame)))
        bpy.context.view_layer.update()
        world = [rig.matrix_world @ bone.matrix for bone in rig.pose.bones]
        places.append([list(one.translation) for one in world])
        turns.append([list(one.to_quaternion()) for one in world])
    rate = scene.render.fps / scene.render.fps_base
    return {
        "names": np.array([bone.name for bone in rig.pose.bones]),
        "places": np.array(places),
        "turns": np.array(turns),
        "seconds": (chosen - keys[0]) / rate,
    }


def _chosen(rig: bpy.types.Object, wanted: str | None) -> bpy.types.Action:
    own = rig.animation_data.action if rig.animation_data else None
    if wanted:
        named = [one for one in bpy.data.actions if wanted in one.name or one.name in wanted]
        named.sort(key=lambda one: (not one.name.startswith(f"{rig.name}|{wanted}"), len(one.name)))
        bones = [one for one in named if any("pose.bones" in c.data_path for c in _curves(one))]
        if bones:
            return bones[0]
    return own or bpy.data.actions[0]


def _keyed(action: bpy.types.Action) -> np.ndarray:
    frames = {round(p.co.x, 3) for curve in _curves(action) for p in curve.keyframe_points}
    return np.array(sorted(frames))


if __name__ == "__main__":
    {"make": make, "poses": poses}[sys.argv[1]](Path(sys.argv[2]))
