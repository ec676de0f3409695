"""One measurement in a process of its own: CPU and wall time (medians) and peak memory.

The child runs ``module:function`` on the array in a file, and prints what it measured as JSON. Its
limit is of CPU time, so that a busy machine does not decide who finishes.
"""

from __future__ import annotations

import importlib
import json
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray


def measure(function: str, points: Path, *, repeats: int, limit: float) -> dict[str, Any]:
    """Run ``module:function`` on the points; {"failed": why} beyond so many CPU seconds."""
    command = [sys.executable, "-m", "benchmarks._common", function, str(points), str(repeats)]
    done = subprocess.run([*command, str(limit)], capture_output=True, text=True, check=False)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return {"failed": f"over {limit:g} s"}
    if done.returncode:
        last = done.stderr.strip().splitlines()[-1:] or [f"exit status {done.returncode}"]
        return {"failed": last[0]}
    result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return result


def peak_memory() -> int:
    """Largest resident size of this process since it was reset, in bytes (Linux)."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def circle(n: int) -> NDArray[np.float64]:
    """What the child warms up on."""
    angle = 2 * np.pi * np.arange(n) / n
    return np.column_stack((np.cos(angle), np.sin(angle)))


def run(function: str, points: Path, repeats: int, limit: float) -> dict[str, Any]:
    """Measure in this process, which ends at the limit; repeat while a third of it is not spent."""
    resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit) + 5))
    module, name = function.split(":")
    work = getattr(importlib.import_module(module), name)
    data = np.load(points)
    work(circle(64))
    Path("/proc/self/clear_refs").write_text("5")
    before, cpu, wall = peak_memory(), [], []
    result: dict[str, Any] = {}
    for _ in range(repeats):
        started = time.process_time(), time.perf_counter()
        result = work(data)
        cpu.append(time.process_time() - started[0])
        wall.append(time.perf_counter() - started[1])
        if sum(cpu) > limit / 3:
            break
    return {"cpu": median(cpu), "wall": median(wall), "bytes": peak_memory() - before, **result}


if __name__ == "__main__":
    _, work_name, file, times, most = sys.argv
    print(json.dumps(run(work_name, Path(file), int(times), float(most))))
