"""Fuzzing guided by coverage, with atheris (pip install atheris).

Usage: python -m tests.fuzz.guided bvh|amc|gltf|glb [CORPUS] [-runs=N] [other options of libFuzzer]

The bytes that atheris makes are the file that is read; an AMC comes with an ASF of the corpus.
Without a folder it starts from the kept corpus. An input that ends badly is left in the current
folder as crash-*; put it into ``tests/fuzz/corpus``, and the tests replay it.
"""

from __future__ import annotations

import inspect
import sys
import tempfile
from pathlib import Path
from types import FunctionType

import atheris
from tests.fuzz.holding import outcome
from tests.fuzz.keeping import captures, files_of


def seeds(kind: str, folder: Path) -> None:
    """Write the captures of a format from the kept corpus, one file each."""
    for path in captures():
        if path.suffix == f".{kind}":
            (folder / path.name).write_bytes(path.read_bytes())


def instrument() -> None:
    """Let atheris see what the readers do; its import hook misses editable installations."""
    modules = [module for name, module in sys.modules.items() if name.startswith("roundelay.f")]
    for module in modules:
        classes = [one for _, one in inspect.getmembers(module, inspect.isclass)]
        for holder in (module, *classes):
            for one in vars(holder).values():
                if isinstance(one, FunctionType) and one.__module__ == module.__name__:
                    atheris.instrument_func(one)


def main() -> None:
    kind, *arguments = sys.argv[1:]
    others = [files_of(path) for path in captures() if path.suffix == f".{kind}"]
    beside = {name: content for name, content in others[0].items() if name != f"a.{kind}"}

    def once(data: bytes) -> None:
        end = outcome({f"a.{kind}": data, **beside})
        if end not in ("accepted", "refused"):
            raise AssertionError(end)

    outcome(others[0])  # loads what is loaded when first used
    with tempfile.TemporaryDirectory() as place:
        if not any(not argument.startswith("-") for argument in arguments):
            seeds(kind, Path(place))
            arguments.append(place)
        instrument()
        atheris.Setup([sys.argv[0], *arguments], once)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
