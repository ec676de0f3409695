"""Loops as they are played: three.js in Chromium, Blender's importers, Godot.

Usage: python -m benchmarks.players --data FOLDER [--players three.js,Godot] [--json]

Loops of captures of at least eight sources, blends, transitions and a library, at 24, 30, 60 and
120 frames a second, are written, imported and sampled over two rounds: at 240 samples a second, in
Blender at every half frame, its BVH frame by frame. three.js plays each at all four rates, the
other players at one, in turn (``--every-rate``: all). Per player:

- ``join``: the largest acceleration (second difference of joint positions, the root's travel and
  turning taken out) from a frame before the join to half a frame after it, over the largest
  elsewhere; of a transition, while it goes over, over that before and after it. The worst;
- ``join_over``: the share above 1.1;
- ``step``: the largest step of a joint about the hips, in a thirtieth of a second, over that of
  the capture, the median of its repetitions: the least; ``step_typical``: the median;
  ``step_under``: the share below .9;
- ``kept``: the same over what was written, which tells what the player alone loses;
- ``height``: the share whose first frame is within 5 % of the person's height in metres, where
  the unit is known;
- ``looped``: the share that the player repeats by itself, where it has such a flag;
- ``travel``, ``apart``: by how many body sizes the way in a period, and any joint, differ from
  what was written; the largest.

Players that are not installed are told in ``skipped``.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import cycle as endless
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks._played import Shown, largest_step, record, shown
from benchmarks._players import PLAYERS, Job, Played, Player
from roundelay.cycles.edit.separate import repaired, source_parts
from roundelay.library.workers import spread
from roundelay.loops.exported import exported
from roundelay.loops.units import Lengths

RATES = (24.0, 30.0, 60.0, 120.0)
SOURCES = {
    "bundle": ("bundle", "*.bvh"),
    "acclaim": ("cmu/acclaim", "*/*.amc"),
    **{
        name: (f"truth/{name}", "*.bvh")
        for name in ("bandai1", "bandai2", "cmu", "dog", "lafan1", "snu", "hdm05", "handloop")
    },
}
# A transition: seconds before it, of it and after it.
AROUND, OVER = 1.0, 0.5
# So many pairs of loops are blended and gone between.
PAIRS = 12
JOIN, STEP, HEIGHT, SLIP = 1.1, 0.9, 0.05, 0.01
NAMES = tuple(player.name for player in PLAYERS)
TARGETS = (
    *(Target(f"join.{name}", "<=", JOIN, f"{name}: join over elsewhere") for name in NAMES),
    *(
        Target(f"step_under.{name}", "<=", 0, f"{name}: steps below the capture's")
        for name in NAMES
    ),
    *(Target(f"kept.{name}", ">=", 0.99, f"{name}: steps of what was written") for name in NAMES),
    *(Target(f"height.{name}", ">=", 1, f"{name}: persons of their height") for name in NAMES),
    *(Target(f"travel.{name}", "<=", SLIP, f"{name}: way in a period") for name in NAMES),
    *(Target(f"apart.{name}", "<=", SLIP, f"{name}: joints from where written") for name in NAMES),
    Target("looped.Godot", ">=", 1, "Godot: loops by itself"),
)


@dataclass(frozen=True)
class Piece:
    """A loop or a transition to be played, and the largest steps of what it was made from."""

    name: str
    kind: str
    source: str
    cycles: tuple[rl.Cycle, ...]
    # Lengths a second, at each rate.
    steps: dict[float, float] = field(default_factory=dict)
    # A file of a library, which is played as it is.
    file: Path | None = None

    @property
    def metres(self) -> float | None:
        return Lengths.of(self.cycles[0].skeleton).metres


@dataclass(frozen=True)
class Row:
    """What one player shows of one piece at one rate."""

    piece: Piece
    player: str
    fps: float
    shown: Shown | None = None
    written: float = 0.0
    usual: float = 0.0
    person: float | None = None
    error: str = ""


def main() -> None:
    asked = parser(__doc__, data="folder that holds bundle/, cmu/ and truth/")
    asked.add_argument("--captures", type=int, default=60, help="loops of so many captures")
    asked.add_argument("--players", default=",".join(NAMES), help="names, separated by commas")
    asked.add_argument("--every-rate", action="store_true", help="all players at all rates")
    asked.add_argument("--jobs", type=int, default=2, help="processes that find loops")
    arguments = asked.parse_args()
    warnings.simplefilter("ignore")
    players, skipped = _installed(asked, arguments.players.split(","))
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        loops, files = _loops(arguments.data, arguments.captures, arguments.jobs)
        pieces = [*loops, *mixed(loops), *_shelved(files, loops, Path(folder) / "library")]
        print(f"{len(pieces)} pieces, {time.perf_counter() - started:.0f} s", file=sys.stderr)
        rows = [
            row
            for player in players
            for row in measured(player, pieces, Path(folder), arguments.every_rate)
        ]
    result = {
        "summary": {**_made(pieces), **summary(rows), "skipped": skipped},
        "seconds": round(time.perf_counter() - started, 1),
        "rows": [_plain(row) for row in rows],
    }
    names = [player.name for player in players]
    targets = [one for one in TARGETS if one.path.partition(".")[2] in names]
    report("players", result, targets, arguments, table=map(_line, rows), bulk=["rows"])


def _installed(
    asked: argparse.ArgumentParser, names: Sequence[str]
) -> tuple[list[Player], dict[str, str]]:
    if unknown := set(names) - set(NAMES):
        asked.error(f"expected players among {NAMES}, found {sorted(unknown)}")
    chosen = [player for player in PLAYERS if player.name in names]
    skipped = {player.name: lack for player in chosen if (lack := player.lacks())}
    return [player for player in chosen if player.name not in skipped], skipped


def _loops(folder: Path, count: int, jobs: int) -> tuple[list[Piece], list[Path]]:
    """Return loops of so many captures, as even as can be over the sources, and some files."""
    queues = {
        name: _spaced(sorted((folder / at).glob(what))) for name, (at, what) in SOURCES.items()
    }
    found: dict[str, list[Piece]] = {name: [] for name in queues}
    while (lacking := count - sum(map(len, found.values()))) > 0 and any(queues.values()):
        wanting = sorted((name for name in queues if queues[name]), key=lambda n: len(found[n]))
        share = -(-lacking // len(wanting))
        tasks = [(name, queues[name].pop(0)) for name in wanting for _ in queues[name][:share]]
        for piece in spread(_loop, tasks[:lacking], jobs, lambda task: None):
            if piece is not None:
                found[piece.source].append(piece)
    pieces = [piece for name in found for piece in sorted(found[name], key=lambda p: p.name)]
    return pieces, [path for name in ("bundle", "bandai1", "snu") for path in _files(folder, name)]


def _files(folder: Path, name: str) -> list[Path]:
    at, what = SOURCES[name]
    return _spaced(sorted((folder / at).glob(what)))[:3]


def _spaced(paths: list[Path]) -> list[Path]:
    """Return all, in an order that takes from everywhere soon, and always the same."""
    return [paths[i] for i in np.random.default_rng(len(paths)).permutation(len(paths))]


def _loop(task: tuple[str, Path]) -> Piece | None:
    warnings.simplefilter("ignore")
    source, path = task
    try:
        return piece_of(rl.read(path), path.stem, source)
    except rl.RoundelayError:
        return None


def piece_of(motion: rl.Motion, name: str, source: str) -> Piece:
    """Return the best loop of a capture."""
    cycle = rl.find_cycles(motion)[0]
    cycle, _ = repaired(cycle, source_parts(cycle, motion))
    return Piece(name, "loop", source, (cycle,), _steps(cycle, motion))


def _steps(cycle: rl.Cycle, motion: rl.Motion) -> dict[float, float]:
    """Return the median over repetitions of the largest step, at each rate."""
    motion, found = motion.with_root_motion(), {}
    for fps in RATES:
        length, steps = max(2, round(cycle.period * fps)), []
        for start, stop in cycle.evidence.runs if cycle.evidence else ():
            part = motion[start:stop].resample(fps).positions()
            begins = range(0, max(1, len(part) - length + 1), length)
            steps += [largest_step(part[b : b + length + 1], motion.skeleton, fps) for b in begins]
        found[fps] = float(np.median(steps)) if steps else 0.0
    return found


def mixed(loops: Sequence[Piece]) -> Iterator[Piece]:
    """Yield a blend and a transition of some neighbours that have one skeleton."""
    pairs = [
        (first, second)
        for first, second in pairwise(loops)
        if first.cycles[0].skeleton.names == second.cycles[0].skeleton.names
    ]
    for first, second in pairs[:: -(-len(pairs) // PAIRS) or 1]:
        one, two = first.cycles[0], second.cycles[0]
        name = f"{first.name} {second.name}"
        try:
            blended = rl.blend([one, two], [0.5, 0.5])
        except (ValueError, rl.RoundelayError):  # a joint turns all the way round in one alone
            continue
        yield Piece(name, "blend", first.source, (blended,))
        yield Piece(name, "transition", first.source, (one, two))


def _shelved(files: Sequence[Path], loops: Sequence[Piece], folder: Path) -> Iterator[Piece]:
    """Yield the loops of a library of a few captures, as files that are there."""
    if not files or not loops:
        return
    library = rl.build_library(files, folder, jobs=1, options=rl.LoopOptions(target="godot"))
    for clip, told in library.cycles:
        file = folder / told["loop"]
        (cycle, *_) = (piece.cycles[0] for piece in loops)
        yield Piece(f"{Path(clip).stem} {file.stem}", "library", "library", (cycle,), file=file)


def measured(player: Player, pieces: Sequence[Piece], folder: Path, every_rate: bool) -> list[Row]:
    """Write, play and measure; the pieces at one rate each, in turn, if not at every rate."""
    work = folder / player.name.replace(" ", "-")
    (work / "files").mkdir(parents=True)
    (work / "play").mkdir()
    every = every_rate or player.name == "three.js"
    tasks = [
        (piece, fps)
        for piece, turn in zip(pieces, endless(RATES), strict=False)
        for fps in (RATES if every and piece.file is None else (turn,))
        if piece.file is None or player.suffix == "glb"
    ]
    made = [_written(piece, fps, player, work / "files", n) for n, (piece, fps) in enumerate(tasks)]
    jobs = [Job(file, whole.fps, len(whole) - 1) for file, whole in made]
    seen = player.play(jobs, work / "play")
    print(f"{player.name}: {len(seen)} files played", file=sys.stderr, flush=True)
    return [
        _row(piece, player, whole, played)
        for (piece, _), (_, whole), played in zip(tasks, made, seen, strict=True)
    ]


def _written(
    piece: Piece, fps: float, player: Player, folder: Path, number: int
) -> tuple[Path, rl.Motion]:
    """Write a piece; return the file, and the motion up to the frame that repeats the first."""
    if piece.file is not None:
        return piece.file, rl.read(piece.file)
    file = folder / f"{number}.{player.suffix}"
    if piece.kind == "transition":
        whole = rl.transition(*piece.cycles, OVER, before=AROUND, after=AROUND, fps=fps)
    else:
        options = rl.LoopOptions(
            target=player.target, fps=fps, repeat_first=True, file_format=player.suffix
        )
        whole = exported(piece.cycles[0], options)
    rl.write(whole[:-1] if player.suffix == "bvh" else whole, file)
    return file, whole


def _row(piece: Piece, player: Player, whole: rl.Motion, played: Played | str) -> Row:
    row = Row(piece, player.name, whole.fps)
    if isinstance(played, str):
        return replace(row, error=played)
    joined = (AROUND, AROUND + OVER) if piece.kind == "transition" else None
    try:
        found = shown(played, whole, joined=joined)
    except ValueError as error:
        return replace(row, error=str(error))
    points = whole.positions()
    metres = None if piece.file or joined else piece.metres
    return replace(
        row,
        shown=found,
        written=largest_step(points[:-1], whole.skeleton, whole.fps),
        usual=piece.steps.get(row.fps, 0.0) * _scale(piece, whole),
        person=metres and _height(piece.cycles[0], whole.fps) * metres,
    )


def _scale(piece: Piece, whole: rl.Motion) -> float:
    """Return lengths of what was written over those of the capture."""
    return Lengths.of(whole.skeleton).size / Lengths.of(piece.cycles[0].skeleton).size


def _height(cycle: rl.Cycle, fps: float) -> float:
    """Return how high the first frame reaches above its lowest joint, in the capture's unit."""
    motion = cycle.sample(fps)
    above = list(motion.skeleton.trunk[:-1])
    return float(np.ptp(np.delete(motion.positions()[0, :, motion.up], above)))


def _made(pieces: Sequence[Piece]) -> dict[str, Any]:
    loops = [piece for piece in pieces if piece.kind == "loop"]
    kinds = {
        kind: sum(p.kind == kind for p in pieces) for kind in ("blend", "transition", "library")
    }
    return {"captures": len(loops), "sources": len({p.source for p in loops}), "made": kinds}


def summary(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the figures of each player by name, the worst, and shares."""
    told: dict[str, dict[str, Any]] = {}
    for name in dict.fromkeys(row.player for row in rows):
        own = [row for row in rows if row.player == name]
        for key, value in _figures(own).items():
            if value is not None:
                told.setdefault(key, {})[name] = value
    return told


def _figures(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the figures of one player."""
    good = [(row, row.shown) for row in rows if row.shown]
    loops = [(row, seen) for row, seen in good if row.piece.kind != "transition"]
    joins = [seen.join for _, seen in good if np.isfinite(seen.join)]
    steps = [seen.step / row.usual for row, seen in good if row.usual]
    kept = [seen.step / row.written for row, seen in good if row.written > 0]
    tall = [abs(seen.height / row.person - 1.0) <= HEIGHT for row, seen in good if row.person]
    flags = [seen.looped for _, seen in loops if seen.looped is not None]
    return {
        "played": len(good),
        "failed": len(rows) - len(good),
        "join": _rounded(max(joins, default=None)),
        "join_over": _share(join > JOIN for join in joins),
        "step": _rounded(min(steps, default=None)),
        "step_typical": _rounded(float(np.median(steps)) if steps else None),
        "step_under": _share(step < STEP for step in steps),
        "kept": _rounded(min(kept, default=None)),
        "height": _share(tall),
        "looped": _share(flags),
        "travel": _rounded(max((seen.travel for _, seen in loops), default=None)),
        "apart": _rounded(max((seen.apart for _, seen in good), default=None)),
        "seconds": _rounded(max((seen.seconds for _, seen in loops), default=None)),
    }


def _share(flags: Iterable[bool | None]) -> float | None:
    found = list(flags)
    return round(sum(map(bool, found)) / len(found), 3) if found else None


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.3g}")


def _plain(row: Row) -> dict[str, Any]:
    piece = row.piece
    head = {"piece": piece.name, "kind": piece.kind, "source": piece.source}
    told = record(row.shown) if row.shown else {"error": row.error}
    more = {"usual": row.usual, "written": row.written, "person": row.person} if row.shown else {}
    return {**head, "player": row.player, "fps": row.fps, **told, **more}


def _line(row: Row) -> str:
    head = f"{row.player}, {row.piece.kind} {row.piece.name} at {row.fps:g} fps"
    if row.shown is None:
        return f"{head}: {row.error}"
    return f"{head}: join {row.shown.join:.2f}, step {row.shown.step:.3g}"


if __name__ == "__main__":
    main()
