"""Run the fuzzer for as long as is asked, in several processes; see `tests.fuzz`.

Usage: python -m tests.fuzz [--runs N] [--minutes M] [--jobs J] [--seed S]
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter

from tests.fuzz.running import keep, run, told


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


if __name__ == "__main__":
    main()
