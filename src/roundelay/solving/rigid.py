"""Any body of markers: bones by rigidity, joints by centres of rotation.

Markers whose distances hardly change are on one bone. Two bones that hang together turn about a
centre that lies still in both: the symmetrical centre of rotation (SCoRE; Ehrig et al. 2006, J.
Biomech. 39, 2798-2809). The tree joins the bones whose centres fit best.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import Unsolvable
from roundelay.geometry import rotations as rot
from roundelay.motion.frame import Frame, trunk_frame
from roundelay.motion.poses import Mask
from roundelay.solving.body import Body, chained
from roundelay.solving.person import Guess, attached
from roundelay.solving.thresholds import RIGID, SHAPES

__all__ = ["guessed_bones", "rigid_clusters"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]


def guessed_bones(positions: Array, seen: Mask) -> Guess:
    """Find bones and joints of markers whose names tell nothing, and first poses.

    Parameters
    ----------
    positions : (F, N, 3) ndarray
        Points, scaled so that the body is about as large as a person in metres.
    seen : (F, N) ndarray of bool

    Raises
    ------
    Unsolvable
        If there are no two bones with three markers each.
    """
    clusters = rigid_clusters(positions, seen)
    frames = [trunk_frame(positions, seen, cluster, planar=False) for cluster in clusters]
    joined = _tree([_bone(frame, seen) for frame in frames])
    if len(joined) < 2:
        raise Unsolvable("two bones that turn about a joint, each with 3 markers or more")
    # At rest bones stand as they do in the frame that shows most.
    rest = int(np.argmax(seen.sum(axis=1)))
    turns = np.stack([frames[bone].turns for bone, _, _ in joined], axis=1)
    turns = rot.multiply(turns, rot.conjugate(turns[rest])[None])
    parents = tuple(parent for _, parent, _ in joined)
    at = np.stack([frames[bone].outside(place[None, None])[:, 0] for bone, _, place in joined], 1)
    axes = rot.to_matrix(turns)
    carriers: list[int | None] = [None] * seen.shape[1]
    for place, (bone, _, _) in enumerate(joined):
        for point in clusters[bone]:
            carriers[point] = place
    points, joints, on_bones = attached(positions, seen, carriers, at, axes)
    above = list(parents[1:])
    count = len(parents)
    offsets = np.zeros((count, 3))
    apart = np.einsum("fjik,fji->fjk", axes[:, above], at[:, 1:] - at[:, above])
    offsets[1:] = np.median(apart, axis=0)
    body = Body(
        tuple(f"Bone{number}" for number in range(1, count + 1)),
        parents,
        offsets,
        np.full((count, 3), RIGID.joint),
        joints,
        on_bones,
        np.full((len(points), 3), SHAPES.marker),
        np.full((count, 3), np.inf),
        np.zeros(count),
    )
    return Guess(body, chained(parents, at, turns), points)


def rigid_clusters(positions: Array, seen: Mask) -> list[Places]:
    """Return sets of three or more markers, not in one line, that keep their distances.

    Parameters
    ----------
    positions : (F, N, 3) ndarray
    seen : (F, N) ndarray of bool
    """
    changes, shape = _changes(positions, seen)
    clusters = _linked(changes)
    kept = [np.array(sorted(cluster), np.intp) for cluster in clusters if len(cluster) >= 3]
    return [cluster for cluster in kept if _broad(shape[np.ix_(cluster, cluster)])]


def _changes(positions: Array, seen: Mask) -> tuple[Array, Array]:
    """Return how much distances of markers change (N, N), and their medians."""
    rows = np.unique(np.linspace(0, len(positions) - 1, RIGID.frames).round().astype(int))
    shown = np.where(seen[rows, :, None], positions[rows], np.nan)
    count = shown.shape[1]
    changes, medians = np.full((count, count), np.inf), np.zeros((count, count))
    for point in range(count):
        apart = np.linalg.norm(shown - shown[:, point, None], axis=2)
        common = np.isfinite(apart).sum(axis=0)
        enough = common >= max(RIGID.fewest, RIGID.common * len(rows))
        middle = np.nanmedian(apart[:, enough], axis=0)
        far = np.nanquantile(np.abs(apart[:, enough] - middle), SHAPES.often, axis=0)
        changes[point, enough], medians[point, enough] = far, middle
    np.fill_diagonal(changes, 0.0)
    return changes, medians


def _linked(changes: Array) -> list[list[int]]:
    """Join the nearest sets again and again (complete linkage) while all distances keep."""
    apart = changes.copy()
    np.fill_diagonal(apart, np.inf)
    members = {place: [place] for place in range(len(apart))}
    while len(members) > 1:
        a, b = sorted(int(i) for i in np.unravel_index(np.argmin(apart), apart.shape))
        if not apart[a, b] < RIGID.loose:
            break
        members[a] += members.pop(b)
        apart[a] = apart[:, a] = np.maximum(apart[a], apart[b])
        apart[a, a] = np.inf
        apart[b] = apart[:, b] = np.inf
    return sorted(members.values(), key=len, reverse=True)


def _broad(distances: Array) -> bool:
    """Tell whether points with some distances (k, k) do not lie in one line."""
    size = len(distances)
    centring = np.eye(size) - 1.0 / size
    spread = np.linalg.eigvalsh(-0.5 * centring @ distances**2 @ centring)[::-1]
    return bool(spread[1] > RIGID.broad**2)


@dataclass(frozen=True, eq=False)
class _Bone:
    """Hold the frame of a bone, its axes (F, 3, 3), and in which frames it is told (F,)."""

    frame: Frame
    axes: Array
    told: NDArray[np.bool_]


def _bone(frame: Frame, seen: Mask) -> _Bone:
    """Find in which frames the markers of a bone that are seen do not lie in one line."""
    share = seen[:, frame.trunk] / np.maximum(seen[:, frame.trunk].sum(axis=1, keepdims=True), 1)
    apart = frame.shape - (share @ frame.shape)[:, None]
    spread = np.linalg.eigvalsh(np.einsum("fn,fni,fnj->fij", share, apart, apart))
    return _Bone(frame, rot.to_matrix(frame.turns), spread[:, 1] > RIGID.line**2)


def _centre(first: _Bone, second: _Bone) -> tuple[Array, Array, float]:
    """Return the centre in both bones, each (3,), and how far it is from one, plus its nearness.

    Least squares of R_1 c_1 + t_1 - R_2 c_2 - t_2 over all frames (Ehrig et al. 2006, eq. 6);
    directions in which the bones do not turn against each other are told by the middle of both.
    """
    told = first.told & second.told
    if told.sum() < SHAPES.fewest:
        return np.zeros(3), np.zeros(3), np.inf
    a, b = first.axes[told], second.axes[told]
    s, t = first.frame.places[told], second.frame.places[told]
    middle = 0.5 * (s + t)
    guess = np.concatenate(
        [
            np.median(np.einsum("fik,fi->fk", a, middle - s), axis=0),
            np.median(np.einsum("fik,fi->fk", b, middle - t), axis=0),
        ]
    )
    both, apart = np.concatenate([a, -b], axis=2), t - s
    weights = np.full(len(a), 1.0 / len(a))
    for _ in range(RIGID.rounds):
        matrix = np.einsum("f,fki,fkj->ij", weights, both, both)
        side = np.einsum("f,fki,fk->i", weights, both, apart)
        ridge = weights.sum() * (SHAPES.skin / RIGID.reach) ** 2
        found = np.linalg.solve(matrix + ridge * np.eye(6), side + ridge * guess)
        errors = np.linalg.norm(np.einsum("fki,i->fk", both, found) - apart, axis=1)
        weights = 1.0 / np.maximum(errors, SHAPES.skin) / len(a)
    near = [
        np.linalg.norm(bone.frame.shape - own, axis=1).min()
        for bone, own in ((first, found[:3]), (second, found[3:]))
    ]
    return found[:3], found[3:], float(np.median(errors)) + RIGID.nearness * float(sum(near))


def _tree(bones: list[_Bone]) -> list[tuple[int, int, Array]]:
    """Return bones from the root outward: number, place of the parent in the list, joint in it."""
    edges = {}
    for a in range(len(bones)):
        for b in range(a):
            _, _, price = _centre(bones[a], bones[b])
            if price < RIGID.apart:
                edges[a, b] = price
    tree = _spanning(len(bones), edges)
    if not tree:
        return []
    root = _middle_of(tree)
    result: list[tuple[int, int, Array]] = [(root, -1, bones[root].frame.shape.mean(axis=0))]
    # The list grows while it is walked.
    for place, (bone, _, _) in enumerate(result):
        taken = {one for one, _, _ in result}
        for child in sorted(tree[bone] - taken):
            _, own, _ = _centre(bones[bone], bones[child])
            result.append((child, place, own))
    return result


def _spanning(count: int, edges: dict[tuple[int, int], float]) -> dict[int, set[int]]:
    """Return the least spanning tree (Kruskal 1956) of the largest part that hangs together."""
    part = {bone: {bone} for bone in range(count)}
    tree: dict[int, set[int]] = {bone: set() for bone in range(count)}
    for a, b in sorted(edges, key=lambda pair: edges[pair]):
        if part[a] is not part[b]:
            part[a] |= part[b]
            for bone in part[b]:
                part[bone] = part[a]
            tree[a].add(b)
            tree[b].add(a)
    largest = max(part.values(), key=len, default=set())
    return {bone: tree[bone] for bone in sorted(largest)}


def _middle_of(tree: dict[int, set[int]]) -> int:
    """Return the bone from which the farthest is nearest."""

    def reach(bone: int, above: int = -1) -> int:
        return 1 + max((reach(other, bone) for other in tree[bone] if other != above), default=0)

    return min(tree, key=lambda bone: (reach(bone), -len(tree[bone])))
