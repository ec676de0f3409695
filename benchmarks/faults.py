"""Runs that are ended at any moment, full disks, two runs at once, damaged files: what is lost.

Usage: python -m benchmarks.faults [--json] [--keep] [--moments N] [--corruptions N]

Every command that writes is ended by KILL, TERM, HUP and INT at so many moments spread over the
time that it takes. Its folder may then hold whole files only, with what an uninterrupted run
writes, and nothing else but for what KILL leaves of a file in the making; a second run gives what
an uninterrupted one gives. A worker of a library is killed; files may not grow beyond a size, as on
a full disk; sources may not be written to; two runs are started at once. Files of a library are
damaged at random: each is refused by name or mended, nothing wrong is read.
"""

from __future__ import annotations

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks._harness import Target, parser, report
from roundelay import synth
from roundelay.base.files import is_part

COMMANDS = {
    "loop": ["loop", "{a}", "{b}", "-o", "{out}/"],
    "segment": ["segment", "{a}", "-o", "{out}/", "--split"],
    "timeline": ["timeline", "{a}", "-o", "{out}/"],
    "inspect": ["inspect", "{a}", "-o", "{out}/"],
    "excitations": ["excitations", "{a}", "-o", "{out}/"],
    "view": ["view", "{a}", "-o", "{out}/"],
    "close": ["close", "{a}", "--frames", "5:38", "-o", "{out}/"],
    "convert": ["convert", "{a}", "{out}/a.amc"],
    "blend": ["blend", "{a}", "{b}", "-o", "{out}/"],
    "transition": ["transition", "{a}", "{b}", "-o", "{out}/"],
    "library": ["library", "{source}", "-o", "{out}", "--jobs", "1"],
    "library, 2 jobs": ["library", "{source}", "-o", "{out}", "--jobs", "2"],
}
SIGNALS = ("SIGKILL", "SIGTERM", "SIGHUP", "SIGINT")
TARGETS = (
    Target("wrong_reads", "<=", 0, "files that hold something else than an uninterrupted run's"),
    Target("not_mended", "<=", 0, "second runs that do not give what an uninterrupted one gives"),
    Target("left_over", "<=", 0, "files that neither run writes"),
    Target("other_exceptions", "<=", 0, "tracebacks, and exit codes that say nothing"),
)
# Of these the time of writing is part.
DATED = {"library.json", "clips.jsonl", "library.duckdb", "runs.parquet"}


class Ledger:
    """Count what was tried and what went wrong, and keep what was said of it."""

    def __init__(self) -> None:
        self.tried: Counter[str] = Counter()
        self.wrong: Counter[str] = Counter()
        self.told: list[str] = []

    def note(self, kind: str, what: str, is_wrong: bool) -> None:
        if is_wrong:
            self.wrong[kind] += 1
            self.told.append(f"{kind}: {what}")


def captures(folder: Path) -> dict[str, str]:
    """Make a folder of four captures; return what the commands' words stand for."""
    source = folder / "source"
    source.mkdir()
    for name, kind in {"a": "walk", "b": "walk", "c": "run", "d": "jacks"}.items():
        made = synth.gait(kind, repetitions=2.6, seed=ord(name), fps=30.0).motion
        rl.write(made, source / f"{name}.bvh")
    return {"source": str(source), "a": str(source / "a.bvh"), "b": str(source / "b.bvh")}


def started(command: Sequence[str], most_bytes: int | None = None) -> subprocess.Popen[str]:
    def limited() -> None:
        if most_bytes is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))

    return subprocess.Popen(
        [sys.executable, "-m", "roundelay", *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=limited,
    )


def words(name: str, known: dict[str, str], out: Path) -> list[str]:
    return [word.format(**known, out=out) for word in COMMANDS[name]]


def contents(folder: Path) -> dict[str, bytes]:
    """Return what all files of a folder hold, those that tell the time without it."""
    found = {}
    for path in sorted(folder.rglob("*")) if folder.exists() else ():
        if path.is_file():
            name = path.relative_to(folder).as_posix()
            found[name] = _undated(path) if path.name in DATED else path.read_bytes()
    return found


def _undated(path: Path) -> bytes:
    if path.suffix != ".json":
        return b""
    record = json.loads(path.read_bytes())
    for name in ("written", "crc32", "summary", "clips", "groups", "checksums"):
        record.pop(name, None)
    return json.dumps(record).encode()


def ended(known: dict[str, str], folder: Path, moments: int, ledger: Ledger) -> Iterator[str]:
    """End every command at every moment by every signal."""
    for name in COMMANDS:
        whole = folder / "whole"
        start = time.monotonic()
        run = started(words(name, known, whole))
        _, said = run.communicate()
        lasted = time.monotonic() - start
        assert run.returncode == 0, said
        for number in SIGNALS:
            for moment in range(moments):
                out = folder / "out"
                run = started(words(name, known, out))
                time.sleep(lasted * (moment + 0.5) / moments)
                run.send_signal(getattr(signal, number))
                after(f"{name} {number} {moment}", run, known, name, out, whole, ledger)
                shutil.rmtree(out, ignore_errors=True)
            yield f"{name} {number}: {dict(ledger.wrong)}"
        shutil.rmtree(whole)


def after(
    what: str,
    run: subprocess.Popen[str],
    known: dict[str, str],
    name: str,
    out: Path,
    whole: Path,
    ledger: Ledger,
) -> None:
    """Look at what a run left that was ended, and at what a second one makes of it."""
    said, complained = run.communicate()
    ledger.tried["ended runs"] += 1
    killed = run.returncode == -signal.SIGKILL
    # Until Python itself has started, it is Python that ends.
    early = run.returncode in (-signal.SIGTERM, -signal.SIGHUP, -signal.SIGINT)
    at_start = "Traceback" in complained and "roundelay/cli" not in complained and not said
    ledger.note(
        "other_exceptions",
        f"{what}: {complained[-500:]}",
        ("Traceback" in complained and not at_start)
        or not (killed or early or run.returncode in (0, 130, 1)),
    )
    expected = contents(whole)
    for file, content in contents(out).items():
        plain = Path(file).name
        derived = Path(file).suffix in (".csv", ".json", ".npy", ".parquet", ".usearch")
        partial = name.startswith("library") and (plain in DATED or derived)
        if is_part(plain) or plain == "library.lock":
            ledger.note("left_over", f"{what}: {file}", not killed)
        elif file not in expected:
            ledger.note("left_over", f"{what}: {file}", True)
        elif not partial:  # of a library, these tell of what is done by then
            ledger.note("wrong_reads", f"{what}: {file}", content != expected[file])
    again = started(words(name, known, out))
    _, complained = again.communicate()
    found = {n: c for n, c in contents(out).items() if not (killed and is_part(Path(n).name))}
    found.pop("library.lock", None)
    ledger.note("not_mended", f"{what}: {complained[-300:]}", found != expected)


def full(known: dict[str, str], folder: Path, ledger: Ledger) -> None:
    """Let no file grow beyond some sizes; then run again without a limit."""
    for name in COMMANDS:
        whole, out = folder / "whole", folder / "out"
        started(words(name, known, whole)).communicate()
        for size in (0, 300, 3000, 20_000):
            run = started(words(name, known, out), size)
            _, complained = run.communicate()
            ledger.tried["full disks"] += 1
            expected = contents(whole)
            largest = max(map(len, expected.values()))
            named = "File too large" in complained and f"{out}" in complained
            named |= str(tempfile.gettempdir()) in complained and name == "view"
            bad = "Traceback" in complained or (run.returncode not in (0, 2, 3))
            ledger.note("other_exceptions", f"{name} {size}: {complained[-400:]}", bad)
            silent = run.returncode == 0 and size < largest and not name.startswith("library")
            ledger.note("wrong_reads", f"{name} {size}: ended well", silent)
            ledger.note(
                "other_exceptions",
                f"{name} {size}: {complained}",
                bool(run.returncode) and not named,
            )
            started(words(name, known, out)).communicate()
            ledger.note("not_mended", f"{name} {size}", contents(out) != expected)
            shutil.rmtree(out, ignore_errors=True)
        shutil.rmtree(whole)


def workers(known: dict[str, str], folder: Path, moments: int, ledger: Ledger) -> None:
    """Kill one of the processes of a library."""
    whole, out = folder / "whole", folder / "out"
    name = "library, 2 jobs"
    started(words(name, known, whole)).communicate()
    for moment in range(moments):
        run = started(words(name, known, out))
        pids = children_of(run)
        time.sleep(0.1 * moment)
        for pid in pids[-1:]:
            os.kill(pid, signal.SIGKILL)
        _, complained = run.communicate()
        ledger.tried["killed workers"] += bool(pids)
        bad = "Traceback" in complained or run.returncode not in (0, 2, 3)
        ledger.note("other_exceptions", f"worker {moment}: {complained[-400:]}", bad)
        started(words(name, known, out)).communicate()
        ledger.note("not_mended", f"worker {moment}", contents(out) != contents(whole))
        shutil.rmtree(out, ignore_errors=True)
    shutil.rmtree(whole)


def children_of(run: subprocess.Popen[str]) -> list[int]:
    """Wait until a run has as many processes as it was asked for, or ends; return their ids."""
    found: list[int] = []
    while run.poll() is None and len(found) < 3:  # one watches over what they share
        path = Path(f"/proc/{run.pid}/task/{run.pid}/children")
        found = [int(word) for word in path.read_text().split()] if path.exists() else []
        time.sleep(0.01)
    return found


def at_once(known: dict[str, str], folder: Path, ledger: Ledger) -> None:
    """Start two runs on one library, and more on folders whose sources may not be written to."""
    whole, out, source = folder / "whole", folder / "out", Path(known["source"])
    before = contents(source)
    source.chmod(0o555)
    started(words("library", known, whole)).communicate()
    for _ in range(5):
        both = [started(words("library", known, out)) for _ in range(2)]
        ends = [(*run.communicate(), run.returncode) for run in both]
        ledger.tried["two at once"] += 1
        excluded = [said for _, said, code in ends if code == 2 and "at work on it" in said]
        fine = [code for _, _, code in ends if code == 0]
        ledger.note("other_exceptions", f"at once: {ends}", len(excluded) + len(fine) != 2)
        ledger.note("wrong_reads", "at once", contents(out) != contents(whole))
        shutil.rmtree(out)
    source.chmod(0o755)
    ledger.note("wrong_reads", "a source was written to", contents(source) != before)
    shutil.rmtree(whole)


def corrupted(known: dict[str, str], folder: Path, count: int, ledger: Ledger) -> Iterator[str]:
    """Damage a file of a library of one clip, open it, and run again."""
    whole, out, source = folder / "whole", folder / "out", Path(known["a"])
    kept = _built(source, whole)
    files = [path for path in sorted(whole.rglob("*")) if path.is_file()]
    chance = random.Random(0)
    for number in range(count):
        shutil.copytree(whole, out)
        file = out / files[number % len(files)].relative_to(whole)
        data = file.read_bytes()
        file.write_bytes(_damaged(data, chance))
        if file.read_bytes() == data:
            shutil.rmtree(out)
            continue
        ledger.tried["corruptions"] += 1
        what = f"corruption {number} of {file.name}"
        try:
            wrong = _told(rl.Library.open(out)) != _told(kept)
            ledger.note("wrong_reads", what, wrong)
        except rl.FormatError as error:
            ledger.tried["corruptions refused by name"] += str(out) in str(error)
        try:
            again = _built(source, out)
            found = {n: c for n, c in contents(out).items() if not n.endswith(".changed")}
            same = _told(again) == _told(kept) and found == contents(whole)
            ledger.note("not_mended", what, not same)
        except rl.RoundelayError as error:
            ledger.tried["corruptions that a second run refuses by name"] += 1
            ledger.note("other_exceptions", f"{what}: {error}", str(out) not in str(error))
        except Exception as error:
            ledger.note("other_exceptions", f"{what}: {type(error).__name__} {error}", True)
        shutil.rmtree(out)
        if number % 100 == 99:
            yield f"{number + 1} corruptions: {dict(ledger.wrong)}"


def _damaged(data: bytes, chance: random.Random) -> bytes:
    at, length = chance.randrange(len(data)), chance.choice((1, 1, 8, 100, 4096))
    noise = bytes(chance.randrange(256) for _ in range(length))
    match chance.randrange(6):
        case 0:
            return data[:at]
        case 1:
            return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]
        case 2:
            return data[:at] + noise + data[at + length :]
        case 3:
            return data[:at] + data[at + length :]
        case 4:
            return data[:at] + bytes(length) + data[at + length :]
        case _:
            return data + noise


def _built(source: Path, folder: Path) -> rl.Library:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        return rl.build_library(source, folder, jobs=1)


def _told(library: rl.Library) -> dict[str, Any]:
    return {name: value for name, value in library.record.items() if name != "written"}


def main() -> None:
    options = parser(__doc__, data=None)
    options.add_argument("--moments", type=int, default=30, help="of each signal and command")
    options.add_argument("--corruptions", type=int, default=1000)
    arguments = options.parse_args()
    ledger = Ledger()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        known = captures(folder)
        for line in ended(known, folder, arguments.moments, ledger):
            print(line, file=sys.stderr, flush=True)
        full(known, folder, ledger)
        workers(known, folder, max(1, arguments.moments // 2), ledger)
        at_once(known, folder, ledger)
        for line in corrupted(known, folder, arguments.corruptions, ledger):
            print(line, file=sys.stderr, flush=True)
    kinds = [target.path for target in TARGETS]
    summary = {**{kind: ledger.wrong[kind] for kind in kinds}, "tried": dict(ledger.tried)}
    table = [f"{kind}: {count}" for kind, count in summary.items()] + ledger.told
    report("faults", {"summary": summary, "told": ledger.told}, TARGETS, arguments, table=table)


if __name__ == "__main__":
    main()
