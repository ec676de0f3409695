"""Tables A.1-A.3 and B.1-B.3 of [C], row by row: published, our faithful models, our default.

    python -m benchmarks.harmonic --data FOLDER [--json] [--rows 07_01 09_01 ...]

Two metrics, the same for the faithful models and for the default, both template matching
([C] eq. 4.4, 4.5) over whole captures (table C.1 for boxing):

- *euler*: distance of the Euler angles of all joints, root's rotation included or not, in the
  file's own channels (see `euler_angles`), radians, unwrapped;
  of equivalent triples of the loop the one nearest to the capture's is taken. The root's
  translation is out. The root's rotation of the default, which travels and turns, is laid
  against the capture's at the best heading.
- *rotation*: root of the sum of squared angles of rotation between loop and capture.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay
from benchmarks.raunio_tables import PUBLISHED, SCALE, Published
from roundelay.cycles import paper
from roundelay.formats.acclaim import AcclaimLayout
from roundelay.formats.euler import decompose
from roundelay.geometry import rotations as rot
from roundelay.motion import Motion
from roundelay.quality import quality

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """What was measured of one capture."""

    published: Published
    frames: int
    faithful: dict[str, dict[str, Any]]
    default: dict[str, Any]


def captures(data: Path) -> dict[str, Path]:
    """Find the captures of the tables: AMC where there is one, else BVH."""
    found = {}
    for row in PUBLISHED:
        amc = data / "cmu" / "acclaim" / row.trial[:2] / f"{row.trial}.amc"
        bvh = data / "cmu" / "bvh" / f"{row.trial}.bvh"
        if amc.exists() or bvh.exists():
            found[row.trial] = amc if amc.exists() else bvh
    return found


def load(path: Path, frames: tuple[int, int] | None) -> Motion:
    """Read a capture, without the T-pose that the BVH conversions begin with."""
    motion = roundelay.read(path)
    motion = motion[1:] if path.suffix == ".bvh" else motion
    return motion if frames is None else motion[frames[0] : frames[1]]


def euler_angles(motion: Motion, rotations: Array) -> Array:
    """Return the file's channels (F, J, 3) in radians, unwrapped; three for every joint.

    In the order of a BVH's channels; of ASF/AMC about the bone's own axes, rx ry rz, as [C]'s
    figures are reproduced best. A loop may leave the channels a bone has: all three count.
    """
    layout = motion.skeleton.layout
    if isinstance(layout, AcclaimLayout):
        axes = layout.local_axes()
        rotations = rot.multiply(rot.conjugate(axes), rot.multiply(rotations, axes))
        return np.radians(decompose(rotations, "ZYX", "continuous"))
    result = np.zeros((*rotations.shape[:2], 3))
    for order in set(layout.orders):
        joints = [joint for joint, other in enumerate(layout.orders) if other == order]
        angles = decompose(rotations[:, joints], order, "continuous")
        result[:, joints, : len(order)] = np.radians(angles)
    return result


def euler_squares(capture: Array, loop: Array) -> Array:
    """Return squared distances (M, N, J) of Euler angles, over equivalent triples the least."""
    best = np.full((len(capture), len(loop), capture.shape[1]), np.inf)
    for triple in (loop, loop * (1.0, -1.0, 1.0) + np.pi):
        apart = capture[:, None] - triple
        apart -= 2 * np.pi * np.round(apart / (2 * np.pi))
        best = np.minimum(best, np.einsum("mnjk,mnjk->mnj", apart, apart))
    return best


def rotation_squares(capture: Array, loop: Array) -> Array:
    """Return squared angles of rotation (M, N, J)."""
    cosine = np.abs(np.einsum("mjk,njk->mnj", capture, loop))
    return (2.0 * np.arccos(np.minimum(cosine, 1.0))) ** 2


def matched(squares: Array, *, root: bool) -> float:
    """Lay a repeated loop against a capture: [C] eq. 4.4, 4.5 on squared distances (M, N, J)."""
    apart = np.sqrt(squares[:, :, 0 if root else 1 :].sum(axis=2))
    where, size = np.arange(len(apart)), apart.shape[1]
    rows = [apart[where, (where + n) % size] for n in range(size)]
    best = min(rows, key=lambda row: float(row.sum()))
    return float(np.sqrt(np.mean(best**2)))


def _composed(motion: Motion, angles: Array) -> Array:
    """Return rotations (F, J, 4) of angles as `euler_angles` gives them."""
    layout = motion.skeleton.layout
    if isinstance(layout, AcclaimLayout):
        axes = layout.local_axes()
        own = rot.from_euler(angles, "ZYX")
        return rot.multiply(axes, rot.multiply(own, rot.conjugate(axes)))
    turned = rot.identity(*angles.shape[:2])
    for joint, order in enumerate(layout.orders):
        turned[:, joint] = rot.from_euler(angles[:, joint, : len(order)], order)
    return turned


def errors(motion: Motion, loop: Array) -> dict[str, float]:
    """Measure a loop of rotations (N, J, 4) by both metrics."""
    euler = euler_squares(euler_angles(motion, motion.rotations), euler_angles(motion, loop))
    turned = rotation_squares(motion.rotations, loop)
    return {
        "euler_with_root": matched(euler, root=True),
        "euler": matched(euler, root=False),
        "rotation": matched(turned, root=False),
    }


def faithful(motion: Motion, row: Published) -> dict[str, dict[str, Any]]:
    """Run M1, M2 and M3 with the settings of the tables."""
    angles = euler_angles(motion, motion.rotations)
    results = {}
    for model in ("M1", "M2", "M3"):
        options = paper.PaperOptions(model=model, scale=SCALE[row.kind])
        try:
            found = _with_primes(angles.reshape(len(motion), -1), options)
        except roundelay.RoundelayError as error:
            results[model] = {"failed": str(error)}
            continue
        loop = found.sample().reshape(-1, *angles.shape[1:])
        turned = _composed(motion, loop)
        results[model] = {
            **errors(motion, turned),
            "plain": paper.template_error(angles.reshape(len(motion), -1), found.sample())[0],
            "rmse": found.errors,
            "periods": found.period_count,
        }
    return results


def _with_primes(values: Array, options: paper.PaperOptions) -> paper.PaperCycle:
    """Try another prime if the class does not lift, as [C] advises its user."""
    for prime in (options.prime, 11, 23):
        try:
            return paper.extract(values, paper.PaperOptions(**{**asdict(options), "prime": prime}))
        except roundelay.LiftError as error:
            refused = error
    raise refused


def default(motion: Motion, row: Published) -> dict[str, Any]:
    """Run the default and measure its first cycle."""
    begun = time.perf_counter()
    try:
        cycle = roundelay.find_cycles(motion)[0]
    except roundelay.RoundelayError as error:
        return {"failed": str(error)}
    seconds = time.perf_counter() - begun
    loop = cycle.sample(in_place=True)
    turning = abs(cycle.turning) > 0.1
    return {
        **errors(motion, loop.rotations),
        "turning": turning,
        "periods": cycle.evidence.repetitions if cycle.evidence else float("nan"),
        "period": cycle.period * motion.fps,
        "seconds": seconds,
        **{f"q_{name}": value for name, value in asdict(quality(cycle, motion)).items()},
    }


def measure(data: Path, only: Sequence[str], *, with_paper: bool) -> list[Row]:
    """Measure every capture of the tables that is there."""
    rows = []
    for row in PUBLISHED:
        path = captures(data).get(row.trial)
        if path is None or (only and row.trial not in only):
            continue
        motion = load(path, row.frames)
        old = faithful(motion, row) if with_paper else {}
        rows.append(Row(row, len(motion), old, default(motion, row)))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--rows", nargs="*", default=[])
    parser.add_argument("--no-paper", action="store_true")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rows = measure(arguments.data, arguments.rows, with_paper=not arguments.no_paper)
    if arguments.json:
        print(json.dumps([asdict(row) for row in rows], indent=1))
    else:
        print_tables(rows)


def print_tables(rows: list[Row]) -> None:
    for row in rows:
        p, d = row.published, row.default
        old = " ".join(
            f"{row.faithful.get(m, {}).get(k, np.nan):5.2f}"
            for m in ("M1", "M2", "M3")
            for k in ("plain", "euler_with_root", "euler")
        )
        rmse = " ".join(f"{v:5.2f}" for v in row.faithful.get("M1", {}).get("rmse", (np.nan,) * 3))
        per = row.faithful.get("M1", {}).get("periods", np.nan)
        print(
            f"{p.kind:6s} {p.trial} {row.frames:4d} pub {p.template[0]:5.2f} n {p.periods:.2f} | "
            f"{old} n {per:.2f} rmse {p.m1_rmse[0]:.2f} ({rmse}) | "
            f"{d.get('euler_with_root', np.nan):5.2f} {d.get('euler', np.nan):5.2f} "
            f"{d.get('rotation', np.nan):5.2f} n {d.get('periods', np.nan):.2f} "
            f"{1e3 * d.get('seconds', np.nan):.0f} ms {d.get('failed', '')[:60]}",
            flush=True,
        )
    for kind in SCALE:
        chosen = [row for row in rows if row.published.kind == kind]
        if not chosen:
            continue

        def median(values: list[float]) -> float:
            return float(np.nanmedian(values)) if values else float("nan")

        print(
            kind,
            len(chosen),
            f"published {median([r.published.template[0] for r in chosen]):.3f}",
            *(
                f"M1 {k} {median([r.faithful.get('M1', {}).get(k, np.nan) for r in chosen]):.3f}"
                for k in ("plain", "euler_with_root", "euler")
            ),
            *(
                f"{k} {median([r.default.get(k, np.nan) for r in chosen]):.3f}"
                for k in ("euler_with_root", "euler", "rotation", "q_template_error")
            ),
        )
        for key in ("euler_with_root", "euler"):
            ratio = [r.default.get(key, np.inf) / r.published.template[0] for r in chosen]
            print(
                f"  {key}: below published {sum(x < 1 for x in ratio)}, worst",
                sorted(
                    zip(
                        np.round(ratio, 2).tolist(),
                        [r.published.trial for r in chosen],
                        strict=True,
                    )
                )[-6:],
            )


if __name__ == "__main__":
    main()
