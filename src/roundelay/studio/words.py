"""The command and the Python that repeat a work."""

from __future__ import annotations

import shlex
from dataclasses import asdict
from typing import Any

from roundelay.base.files import name_of
from roundelay.base.options import declared
from roundelay.loops.options import LoopOptions
from roundelay.studio.work import ENDING, Work

__all__ = ["as_command", "as_python", "is_automatic"]


def is_automatic(work: Work) -> bool:
    """Whether all that was found is taken as it is, so that no work file is needed."""
    numbers = [part.motion for part in work.parts]
    return all(part.untouched for part in work.parts) and numbers == [*range(1, len(numbers) + 1)]


def as_command(work: Work, motions: int) -> str:
    """Return the line that makes the loops of a work.

    Parameters
    ----------
    work : Work
    motions : int
        How many were found in the take.
    """
    if is_automatic(work) and len(work.parts) == motions:
        words = [work.capture, *_flags(work.render)]
    else:
        words = ["--work", f"{name_of(work.path)}{ENDING}"]
    return shlex.join(["roundelay", "loop", *words, "-o", "loops"])


def as_python(work: Work, motions: int) -> str:
    """Return the program that makes the loops of a work.

    Parameters
    ----------
    work : Work
    motions : int
        How many were found in the take.
    """
    name = name_of(work.path)
    if is_automatic(work) and len(work.parts) == motions:
        options = ", ".join(f"{key}={value!r}" for key, value in _given(work.render).items())
        render = f", render=rl.LoopOptions({options})" if options else ""
        loops = f"rl.make_loops(rl.read({work.capture!r}){render})"
    else:
        loops = f"rl.read_work({name + ENDING!r}).loops()"
    stem, ending = f"{name}_loop", f".{work.render.file_format}"
    return (
        "import roundelay as rl\n\n"
        f"for number, loop in enumerate({loops}, 1):\n"
        f"    loop.write({stem!r} + (str(number) if number > 1 else '') + {ending!r})\n"
    )


def _given(render: LoopOptions) -> dict[str, Any]:
    """Return the options that are not the usual ones of the target."""
    usual = asdict(LoopOptions(target=render.target))
    own = {k: v for k, v in asdict(render).items() if v != usual[k]}
    return ({"target": render.target} if render.target else {}) | own


def _flags(render: LoopOptions) -> list[str]:
    flags = {one.name: one.flag for one in declared(LoopOptions)}
    words: list[str] = []
    for key, value in _given(render).items():
        if isinstance(value, bool):
            words.append(f"--{flags[key]}" if value else f"--no-{flags[key]}")
        else:
            words += [f"--{flags[key]}", str(value)]
    return words
