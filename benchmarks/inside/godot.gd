# Plays each scene listed in jobs.json and writes where its bones are, as 32-bit floats.
extends SceneTree


func _init():
	var file = File.new()
	file.open("res://jobs.json", File.READ)
	var jobs = JSON.parse(file.get_as_text()).result
	file.close()
	for job in jobs:
		play(job)
	quit()


func found(node, kind):
	if node.is_class(kind):
		return node
	for child in node.get_children():
		var one = found(child, kind)
		if one:
			return one
	return null


func play(job):
	var packed = load("res://" + job.scene)
	if not packed:
		return
	var scene = packed.instance()
	get_root().add_child(scene)
	var player = found(scene, "AnimationPlayer")
	var skeleton = found(scene, "Skeleton")
	var clip = player.get_animation_list()[0]
	var animation = player.get_animation(clip)
	player.playback_process_mode = AnimationPlayer.ANIMATION_PROCESS_MANUAL
	player.play(clip)
	var names = []
	for bone in range(skeleton.get_bone_count()):
		names.append(skeleton.get_bone_name(bone))
	var out = File.new()
	out.open(job.out + ".f32", File.WRITE)
	var base = skeleton.global_transform
	player.advance(job.start)
	for step in range(int(job.count)):
		for bone in range(skeleton.get_bone_count()):
			var at = base.xform(skeleton.get_bone_global_pose(bone).origin)
			out.store_float(at.x)
			out.store_float(at.y)
			out.store_float(at.z)
		player.advance(job.seconds)
	out.close()
	out.open(job.out + ".json", File.WRITE)
	out.store_string(JSON.print({
		"names": names,
		"duration": animation.length,
		"clip": clip,
		"looped": animation.loop,
	}))
	out.close()
	scene.free()
