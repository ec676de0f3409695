"""Run the fuzzer for as long as is asked, in several processes; see `tests.fuzz`.

Usage: python -m tests.fuzz [--runs N] [--minutes M] [--jobs J] [--seed S]
"""

from __future__ import annotations

import argparse
import hashlib
import json
import signal
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

from tests.fuzz.grammar import FORMATS, Files, made
from tests.fuzz.holding import changed, outcome
from tests.fuzz.keeping import FOLDER, kept

from roundelay.library.workers import Limits, spread

# Runs that one process does at a time, and seconds that one run may take.
BATCH, SECONDS = 500, 10


def files_of(seed: int, corpus: list[Files]) -> tuple[str, Files]:
    """Return the input of a run: two of three by the grammar, else one of the corpus changed."""
    kind = list(FORMATS)[seed % len(FORMATS)]
    if seed // len(FORMATS) % 3 < 2:
        return "grammar", made(kind, seed)
    files = corpus[seed // 12 % len(corpus)]
    return "corpus", changed(files, seed, corpus)


def batch(first: int) -> dict[str, Any]:
    """Do so many runs; count how they end, and keep what ends badly."""
    corpus, counts, failed = kept(), Counter[str](), dict[str, str]()
    signal.signal(signal.SIGALRM, _late)
    for seed in range(first, first + BATCH):
        source, files = files_of(seed, corpus)
        signal.alarm(SECONDS)
        try:
            end = outcome(files)
        except TimeoutError:
            end = "hang"
        finally:
            signal.alarm(0)
        good = end in ("accepted", "refused")
        counts[f"{source} {end if good else 'hang' if end == 'hang' else 'other'}"] += 1
        if not good:
            failed[str(seed)] = end
    return {"counts": counts, "failed": failed}


def _late(*_: object) -> NoReturn:
    raise TimeoutError


def lost(first: int) -> dict[str, Any]:
    return {"counts": Counter(other=1), "failed": {str(first): "the process died"}}


def keep(seed: int) -> None:
    """Write the files of a run that failed into the corpus."""
    _, files = files_of(seed, kept())
    mark = hashlib.sha256(b"".join(files.values())).hexdigest()[:8]
    for name, content in files.items():
        (FOLDER / f"{mark}{Path(name).suffix}").write_bytes(content)


def told(counts: Counter[str], failed: dict[str, str], seconds: float) -> dict[str, Any]:
    grammar = counts["grammar accepted"] + counts["grammar refused"]
    return {
        "fuzz_runs": sum(counts.values()),
        "accepted_share": counts["grammar accepted"] / max(1, grammar),
        "other_exceptions": sum(n for kind, n in counts.items() if "other" in kind),
        "hangs": sum(n for kind, n in counts.items() if "hang" in kind),
        "seconds": seconds,
        "counts": dict(counts),
        "failed": failed,
    }


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--runs", type=int, default=10_000)
    options.add_argument("--minutes", type=float, default=float("inf"))
    options.add_argument("--jobs", type=int, default=2)
    options.add_argument("--seed", type=int, default=0)
    arguments = options.parse_args()
    counts, failed, started = Counter[str](), dict[str, str](), time.monotonic()
    found = run(arguments.seed, arguments.runs, arguments.jobs)
    for result in found:
        counts.update(result["counts"])
        failed.update(result["failed"])
        if time.monotonic() - started > 60.0 * arguments.minutes:
            break
    found.close()
    for seed in failed:
        keep(int(seed))
    print(json.dumps(told(counts, failed, time.monotonic() - started), indent=1))


def run(seed: int, runs: int, jobs: int) -> Iterator[dict[str, Any]]:
    """Do runs in several processes; yield what each batch found."""
    return spread(batch, range(seed, seed + runs, BATCH), jobs, lost, limits=Limits(600.0, 4 << 30))


if __name__ == "__main__":
    main()
