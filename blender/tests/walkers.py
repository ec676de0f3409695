"""A matrix of rigs as animators have them, all of them walking: one stride takes 32.5 frames."""

import math

import bpy
from mathutils import Matrix, Vector

STRIDE, PERIOD, LAST = 1.1, 32.5, 200
# From Z up to what files in centimetres hold, Y up.
LAID = Matrix.Rotation(-math.pi / 2, 4, "X")
SIDES = (("L", 1.0, 0.0), ("R", -1.0, 0.5))
BONES = [
    ("hips", None, (0, 0, 1.0), (0, 0, 1.15)),
    ("spine", "hips", (0, 0, 1.15), (0, 0, 1.35)),
    ("chest", "spine", (0, 0, 1.35), (0, 0, 1.55)),
    ("head", "chest", (0, 0, 1.55), (0, 0, 1.75)),
]
LIMBS = [
    ("thigh", "hips", (0.1, 0, 1.0), (0.1, -0.03, 0.53)),
    ("shin", "thigh", (0.1, -0.03, 0.53), (0.1, 0, 0.08)),
    ("foot", "shin", (0.1, 0, 0.08), (0.1, -0.16, 0.02)),
    ("upper_arm", "chest", (0.18, 0, 1.5), (0.25, 0.02, 1.24)),
    ("forearm", "upper_arm", (0.25, 0.02, 1.24), (0.3, -0.02, 1.0)),
    ("hand", "forearm", (0.3, -0.02, 1.0), (0.31, -0.03, 0.85)),
]
SHOWN = ["hips", "chest", "head"] + [f"{n}.{s}" for n, *_ in LIMBS for s in "LR"]


def armature(name="Walker", extra=(), prefix="", laid=0.0):
    """Make a biped; extra bones as (name, parent, head, tail); laid down in a unit if given."""
    data = bpy.data.armatures.new(name)
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    select(thing)
    bpy.ops.object.mode_set(mode="EDIT")
    for bone, parent, head, tail in [*BONES, *sided(LIMBS), *extra]:
        new = data.edit_bones.new(prefix + bone)
        new.head, new.tail = head, tail
        new.parent = data.edit_bones[prefix + parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    if laid:
        thing["laid"] = laid
        data.transform(Matrix.Scale(laid, 4) @ LAID)
        thing.scale, thing.rotation_euler = (1 / laid,) * 3, (math.pi / 2, 0.0, 0.0)
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = 24, 1.0
    return thing


def sided(bones):
    """Return bones of both sides."""
    middle = {name for name, *_ in BONES} | {"root"}
    for side, sign, _ in SIDES:
        for name, parent, head, tail in bones:
            above = parent if parent is None or parent in middle else f"{parent}.{side}"
            yield (
                f"{name}.{side}",
                above,
                (sign * head[0], *head[1:]),
                (sign * tail[0], *tail[1:]),
            )


def select(*things):
    """Select objects, the first active."""
    for other in bpy.context.selected_objects:
        other.select_set(False)
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[0]


def hips(frame):
    """Return how the hips are moved (3,) and turned about the vertical."""
    phase = 2 * math.pi * frame / PERIOD
    way = STRIDE / PERIOD * frame
    return (0.02 * math.sin(phase), -way, -0.1 + 0.02 * math.cos(2 * phase)), 0.08 * math.sin(phase)


def ankle(frame, offset):
    """Return how an ankle is moved (3,), planted for six tenths of a stride."""
    turn = frame / PERIOD + offset
    part = turn % 1.0
    swing = max(0.0, (part - 0.6) / 0.4)
    eased = swing * swing * (3 - 2 * swing)
    way = STRIDE * (math.floor(turn) + eased + 0.3 - offset)
    return 0.0, -way, 0.12 * math.sin(math.pi * swing) ** 2


def swing(frame, offset):
    """Return the angle of an arm."""
    return 0.5 * math.sin(2 * math.pi * (frame / PERIOD + offset))


def key_hips(thing, frame, name="hips", turned=None):
    """Key the hips, and what else turns with the stride."""
    bone, (place, turn) = thing.pose.bones[name], hips(frame)
    put(bone, Vector(place), frame)
    other = thing.pose.bones[turned or name]
    other.rotation_mode = "XYZ"
    other.rotation_euler = (0.0, turn, 0.0)
    other.keyframe_insert("rotation_euler", frame=frame)


def key_arms(thing, frame, names="upper_arm.{}"):
    """Key the arms by angles, in their own axes."""
    for side, _, offset in SIDES:
        arm = thing.pose.bones[names.format(side)]
        arm.rotation_mode = "XYZ"
        arm.rotation_euler = (swing(frame, offset + 0.5), 0.0, 0.0)
        arm.keyframe_insert("rotation_euler", frame=frame)


def put(bone, moved, frame):
    """Key a bone's place, moved in the armature."""
    thing, moved = bone.id_data, Vector(moved)
    if "laid" in thing:
        moved = thing["laid"] * (LAID.to_3x3() @ moved)
    bone.location = bone.bone.matrix_local.to_3x3().inverted() @ moved
    bone.keyframe_insert("location", frame=frame)


def controls(parent=None):
    """Return the bones of two foot controls."""
    return sided([("ctl", parent, *LIMBS[2][2:])])


def ik_walker(step=1, last=LAST, extra=(), name="Walker", laid=0.0):
    """Keyed on hips and foot controls outside the root, as animators key."""
    thing = armature(name, [*controls(), *extra], laid=laid)
    for side, _, _ in SIDES:
        ik = thing.pose.bones[f"shin.{side}"].constraints.new("IK")
        ik.target, ik.subtarget, ik.chain_count = thing, f"ctl.{side}", 2
        level = thing.pose.bones[f"foot.{side}"].constraints.new("COPY_ROTATION")
        level.target, level.subtarget = thing, f"ctl.{side}"
    for frame in range(1, last + 1, step):
        key_hips(thing, frame, turned="chest")
        key_arms(thing, frame)
        for side, _, offset in SIDES:
            put(thing.pose.bones[f"ctl.{side}"], ankle(frame, offset), frame)
    select(thing)
    return thing


def baked(step=1, last=LAST, extra=(), prefix="", laid=0.0):
    """Key every bone by what the rig with controls does, as importers do."""
    source = ik_walker(last=last)
    target = armature("Baked", extra, prefix, laid)
    names = [bone.name for bone in target.data.bones]
    known = [n for n in names if n.removeprefix(prefix) in source.pose.bones]
    for frame in range(1, last + 1, step):
        bpy.context.scene.frame_set(frame)
        posed = {n: lying(source.pose.bones[n.removeprefix(prefix)].matrix, laid) for n in known}
        for name in known:
            key_pose(target.pose.bones[name], posed, frame, moves=name == known[0])
    bpy.data.objects.remove(source)
    select(target)
    return target


def lying(matrix, laid):
    """Return a pose in an armature that is laid down."""
    if not laid:
        return matrix.copy()
    place = laid * (LAID @ matrix).translation
    return Matrix.Translation(place) @ (LAID @ matrix).to_3x3().to_4x4()


def key_pose(bone, posed, frame, *, moves):
    """Key a bone where it shall be in the armature."""
    known = {}
    if bone.parent is not None:
        known["parent_matrix"] = posed[bone.parent.name]
        known["parent_matrix_local"] = bone.parent.bone.matrix_local
    own = bone.bone.convert_local_to_pose(
        posed[bone.name], bone.bone.matrix_local, invert=True, **known
    )
    bone.rotation_mode = "QUATERNION"
    before = bone.rotation_quaternion.copy()
    bone.rotation_quaternion = own.to_quaternion()
    if before.dot(bone.rotation_quaternion) < 0:
        bone.rotation_quaternion.negate()
    bone.keyframe_insert("rotation_quaternion", frame=frame)
    if moves:
        bone.location = own.translation
        bone.keyframe_insert("location", frame=frame)


def fingers():
    """Return the bones of thirty fingers a hand."""
    for side, sign, _ in SIDES:
        for finger in range(10):
            parent, place = f"hand.{side}", Vector((sign * 0.31, -0.03 + 0.01 * finger, 0.85))
            for joint in range(3):
                name, end = f"finger{finger}.{joint}.{side}", place - Vector((0, 0, 0.03))
                yield name, parent, tuple(place), tuple(end)
                parent, place = name, end


def with_fingers():
    """Sixty fingers' joints that curl with the stride."""
    thing = baked(extra=list(fingers()))
    for bone in thing.pose.bones:
        if bone.name.startswith("finger"):
            bone.rotation_mode = "XYZ"
            for frame in range(1, LAST + 1):
                bone.rotation_euler.x = 0.3 + 0.2 * math.sin(2 * math.pi * frame / PERIOD)
                bone.keyframe_insert("rotation_euler", frame=frame)
    return thing


def spline_walker():
    """A spine along a curve whose ends hooks of two controls move."""
    extra = [
        ("tail1", "hips", (0, 0, 1.0), (0, 0.2, 1.0)),
        ("tail2", "tail1", (0, 0.2, 1.0), (0, 0.4, 1.0)),
        ("tail3", "tail2", (0, 0.4, 1.0), (0, 0.6, 1.0)),
        ("tip", None, (0, 0.6, 1.0), (0, 0.7, 1.0)),
    ]
    thing = ik_walker(extra=extra)
    data = bpy.data.curves.new("Tail", "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("POLY")
    spline.points.add(1)
    for point, place in zip(spline.points, ((0, 0, 1.0), (0, 0.6, 1.0)), strict=True):
        point.co = (*place, 1.0)
    curve = bpy.data.objects.new("Tail", data)
    bpy.context.scene.collection.objects.link(curve)
    for number, bone in ((0, "hips"), (1, "tip")):
        hook = curve.modifiers.new(bone, "HOOK")
        hook.object, hook.subtarget = thing, bone
        hook.vertex_indices_set([number])
        rest = thing.data.bones[bone].matrix_local
        hook.matrix_inverse = rest.inverted()
    bpy.context.view_layer.update()
    along = thing.pose.bones["tail3"].constraints.new("SPLINE_IK")
    along.target, along.chain_count = curve, 3
    for frame in range(1, LAST + 1):
        place, _ = hips(frame)
        wag = 0.1 * math.sin(2 * math.pi * frame / PERIOD)
        put(thing.pose.bones["tip"], Vector(place) + Vector((wag, 0, 0.05 * wag)), frame)
    return thing


def copying():
    """Deforming bones that copy a second skeleton, which alone is keyed."""
    thing = baked(prefix="CTL-")
    bpy.ops.object.mode_set(mode="EDIT")
    edit = thing.data.edit_bones
    for bone in [b for b in edit if b.name.startswith("CTL-")]:
        new = edit.new("DEF-" + bone.name[4:])
        new.head, new.tail, new.roll = bone.head, bone.tail, bone.roll
        bone.use_deform = False
    for bone in [b for b in edit if b.name.startswith("CTL-") and b.parent]:
        edit["DEF-" + bone.name[4:]].parent = edit["DEF-" + bone.parent.name[4:]]
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in thing.pose.bones:
        if bone.name.startswith("DEF-"):
            kinds = ["COPY_ROTATION"] if bone.parent else ["COPY_ROTATION", "COPY_LOCATION"]
            for kind in kinds:
                copy = bone.constraints.new(kind)
                copy.target, copy.subtarget = thing, "CTL-" + bone.name[4:]
    return thing


def driven():
    """Arms that custom properties drive, which alone are keyed, and an influence."""
    thing = ik_walker()
    for side, _, offset in SIDES:
        arm = thing.pose.bones[f"forearm.{side}"]
        arm.rotation_mode = "XYZ"
        thing[f"bend.{side}"] = 0.0
        curve = arm.driver_add("rotation_euler", 0)
        curve.driver.type = "SUM"
        variable = curve.driver.variables.new()
        variable.targets[0].id, variable.targets[0].data_path = thing, f'["bend.{side}"]'
        for frame in range(1, LAST + 1):
            thing[f"bend.{side}"] = 0.4 + swing(frame, offset) * 0.6
            thing.keyframe_insert(f'["bend.{side}"]', frame=frame)
    ik = thing.pose.bones["shin.L"].constraints["IK"]
    for frame in range(1, LAST + 1):
        ik.influence = 1.0
        ik.keyframe_insert("influence", frame=frame)
    return thing


def pushed_down():
    """The action of the rig with controls in a strip, a muted one above it."""
    thing = ik_walker()
    data = thing.animation_data
    action = data.action
    track = data.nla_tracks.new()
    track.strips.new("Walk", 1, action)
    data.action = None
    other = data.nla_tracks.new()
    strip = other.strips.new("Else", 1, action)
    strip.scale, other.mute = 0.5, True
    return thing


def round_trip(folder):
    """Written as FBX by Blender and read again."""
    source = baked()
    path = str(folder / "walk.fbx")
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, LAST
    bpy.ops.export_scene.fbx(
        filepath=path, use_selection=True, add_leaf_bones=False, bake_anim_simplify_factor=0.0
    )
    bpy.data.objects.remove(source)
    bpy.ops.import_scene.fbx(filepath=path)
    (thing,) = (o for o in bpy.context.selected_objects if o.type == "ARMATURE")
    select(thing)
    return thing


def rigify(kind):
    """Rigify's human as it comes, keyed on torso and limbs, by IK or FK."""
    bpy.ops.preferences.addon_enable(module="rigify")
    rig = bpy.data.objects.get("Original rigify") or generated()
    thing = rig.copy()
    thing.data, thing.name = rig.data, f"Rigify {kind}"
    bpy.context.scene.collection.objects.link(thing)
    for bone in thing.pose.bones:
        for constraint in bone.constraints:
            for target in ("target", "pole_target"):
                if getattr(constraint, target, None) == rig:
                    setattr(constraint, target, thing)
            for one in getattr(constraint, "targets", ()):
                one.target = thing if one.target == rig else one.target
    for curve in thing.animation_data.drivers:
        for variable in curve.driver.variables:
            for one in variable.targets:
                one.id = thing if one.id == rig else one.id
    select(thing)
    (rigify_ik if kind == "IK" else rigify_fk)(thing)
    return thing


def generated():
    """Return the generated rig, kept out of the scene."""
    bpy.ops.object.armature_human_metarig_add()
    meta = bpy.context.object
    # Without a face, which is most of its bones, the rig is what games and films pose.
    bpy.ops.pose.rigify_generate()
    (rig,) = (o for o in bpy.data.objects if o.type == "ARMATURE" and o.name == "rig")
    bpy.data.objects.remove(meta)
    rig.name = "Original rigify"
    rig.use_fake_user = True
    for collection in list(rig.users_collection):
        collection.objects.unlink(rig)
    return rig


def rigify_ik(thing):
    """Key torso, feet and hands."""
    for frame in range(1, LAST + 1):
        (x, y, z), turn = hips(frame)
        torso = thing.pose.bones["torso"]
        torso.location = (x, y, z)
        torso.keyframe_insert("location", frame=frame)
        chest = thing.pose.bones["chest"]
        chest.rotation_mode, chest.rotation_euler = "XYZ", (0.0, turn, 0.0)
        chest.keyframe_insert("rotation_euler", frame=frame)
        for side, _, offset in SIDES:
            foot, hand = (thing.pose.bones[f"{n}_ik.{side}"] for n in ("foot", "hand"))
            foot.location = ankle(frame, offset)
            hand.location = (0.0, y + 0.2 * swing(frame, offset), -0.3)
            for bone in (foot, hand):
                bone.keyframe_insert("location", frame=frame)


def rigify_fk(thing):
    """Key torso and limbs by FK; the switches are keyed, too."""
    for side, _, _ in SIDES:
        for limb in ("upper_arm", "thigh"):
            switch = thing.pose.bones[f"{limb}_parent.{side}"]
            switch["IK_FK"] = 1.0
            switch.keyframe_insert('["IK_FK"]', frame=1)
            switch.keyframe_insert('["IK_FK"]', frame=LAST)
    for frame in range(1, LAST + 1):
        torso, (place, turn) = thing.pose.bones["torso"], hips(frame)
        torso.location = place
        torso.keyframe_insert("location", frame=frame)
        for side, _, offset in SIDES:
            ahead = swing(frame, offset)
            for name, angle in (
                ("thigh_fk", ahead),
                ("shin_fk", 0.3 + 0.3 * math.cos(2 * math.pi * (frame / PERIOD + offset))),
                ("foot_fk", -0.2 * ahead),
                ("upper_arm_fk", -ahead),
                ("forearm_fk", 0.4 + 0.2 * turn),
            ):
                bone = thing.pose.bones[f"{name}.{side}"]
                bone.rotation_mode, bone.rotation_euler = "XYZ", (angle, 0.0, 0.0)
                bone.keyframe_insert("rotation_euler", frame=frame)


def mirrored():
    """An object of a negative scale."""
    thing = ik_walker()
    thing.scale.x, thing.rotation_euler.z = -2.0, 0.7
    bpy.context.view_layer.update()
    return thing
