"""Many runs of the fuzzer, in several processes, and how they ended."""

from __future__ import annotations

import hashlib
import signal
from collections import Counter
from collections.abc import Generator
from pathlib import Path
from typing import Any, NoReturn

from tests.fuzz.chance import Files
from tests.fuzz.grammar import FORMATS, made
from tests.fuzz.holding import changed, outcome
from tests.fuzz.keeping import FOLDER, kept

from roundelay.library.workers import Limits, spread

__all__ = ["batch", "keep", "run", "told"]

# Runs that one process does at a time, and seconds of the processor that one run may take: a busy
# machine is no hang.
BATCH, SECONDS = 100, 10


def files_of(seed: int, corpus: list[Files]) -> tuple[str, Files]:
    """Return the input of a run: two of three by the grammar, else one of the corpus changed."""
    kind = list(FORMATS)[seed % len(FORMATS)]
    if seed // len(FORMATS) % 3 < 2:
        return "grammar", made(kind, seed)
    files = corpus[seed // (3 * len(FORMATS)) % len(corpus)]
    return "corpus", changed(files, seed, corpus)


def batch(first: int) -> dict[str, Any]:
    """Do so many runs; count how they end, and keep what ends badly."""
    corpus, counts, failed = kept(), Counter[str](), dict[str, str]()
    signal.signal(signal.SIGPROF, _late)
    for seed in range(first, first + BATCH):
        source, files = files_of(seed, corpus)
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        try:
            end = outcome(files)
        except TimeoutError:
            end = "hang"
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
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


def run(seed: int, runs: int, jobs: int) -> Generator[dict[str, Any]]:
    """Do runs in several processes; yield what each batch found."""
    return spread(batch, range(seed, seed + runs, BATCH), jobs, lost, limits=Limits(600.0, 4 << 30))
