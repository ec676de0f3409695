"""Judge a loop by what Blender plays: against the mean of the capture's own repetitions."""

import bpy
import numpy as np

from inside import curves_of

# What counts as a person, and as the centimetre that a joint may be elsewhere.
BODY, CENTIMETRE = 1.7, 0.01


def keyed(armature):
    """Return what drives an armature: paths with indices, those of strips that play included."""
    data = armature.animation_data
    found = set(curves_of(armature)) if data.action is not None else set()
    tracks = data.nla_tracks if data.use_nla else ()
    for strip in (strip for track in tracks if not track.mute for strip in track.strips):
        action = strip.action
        if hasattr(action, "layers"):
            bags = [s.channelbag(strip.action_slot) for la in action.layers for s in la.strips]
            curves = [curve for bag in bags if bag for curve in bag.fcurves]
        else:
            curves = list(action.fcurves)
        found |= {(curve.data_path, curve.array_index) for curve in curves}
    return found


def heads(armature, frames, names):
    """Return where bones' heads are in the world, (F, J, 3), of a body of 1.7 m."""
    scene, pose = bpy.context.scene, armature.pose.bones
    found = []
    for frame in frames:
        scene.frame_set(int(np.floor(frame)), subframe=float(frame % 1.0))
        found.append([armature.matrix_world @ pose[name].head for name in names])
    return np.array(found)


def size_of(places):
    """Return how tall a body is: the largest extent of its poses."""
    return float(np.median(np.ptp(places, axis=1).max(axis=1)))


def compare(armature, capture, frames, action, names, period):
    """Return how far a loop is from the mean repetition, how it joins and how its feet slide.

    Parameters
    ----------
    capture : (F, J, 3) ndarray
        From `heads`; the first joint is the root.
    frames : (F,) ndarray
        Of the scene: parts of frames, too.
    period : float
        Frames, as the capture was made.
    """
    start, end = int(action.frame_start), int(action.frame_end)
    count = end - start
    unit = BODY / size_of(capture)
    loop = heads(armature, range(start, start + 2 * count + 1), names) * unit
    mean = best_mean(capture * unit, frames, loop[: count + 1], period)
    away = np.linalg.norm(own(loop[: count + 1]) - mean, axis=-1).max()
    return {"away": away, "join": join(loop, count), "loop": loop, "unit": unit}


def own(places):
    """See places from the first joint, heights as they are."""
    return places - places[:, :1] * (1.0, 1.0, 0.0)


def best_mean(capture, frames, loop, period):
    """Return the mean repetition from the phase at which it is nearest to the loop."""
    count, seen, found = len(loop) - 1, own(capture), []
    for offset in np.arange(0.0, period, 0.05):
        times = frames[0] + offset + np.arange(count) * period / count
        every = times + np.arange(-1, len(frames))[:, None] * period
        inside = (every >= frames[0]) & (every <= frames[-1])
        every = every[inside.any(axis=1)]
        rows = np.array([at(seen, frames, row) for row in every])
        weights = ((every >= frames[0]) & (every <= frames[-1]))[..., None, None]
        mean = (rows * weights).sum(axis=0) / weights.sum(axis=0)
        closed = np.concatenate([mean, mean[:1]])
        found.append((np.linalg.norm(own(loop) - closed, axis=-1).max(), offset, closed))
    return min(found, key=lambda row: row[0])[2]


def at(values, frames, times):
    flat = values.reshape(len(values), -1)
    found = [np.interp(times, frames, column) for column in flat.T]
    return np.stack(found, axis=1).reshape(len(times), *values.shape[1:])


def join(loop, count):
    """Return the largest acceleration at the join, as played over it, over that elsewhere."""
    bends = np.linalg.norm(np.diff(loop, n=2, axis=0), axis=-1).max(axis=1)
    middle = np.arange(1, len(loop) - 1) % count
    joined = (middle == 0) | (middle == count - 1)
    return bends[joined].max() / bends[~joined].max()


def slide(loop, joint, height):
    """Return the mean step of a joint while it is below a height on the ground."""
    foot = loop[:, joint]
    low = foot[:, 2] < foot[:, 2].min() + height
    both = low[1:] & low[:-1]
    steps = np.linalg.norm(np.diff(foot[:, :2], axis=0), axis=-1)
    return steps[both].mean() if both.any() else 0.0
