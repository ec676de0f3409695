"""The shell completes commands, options and the names that an option takes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(sys.executable).with_name("roundelay")
pytestmark = pytest.mark.skipif(
    not (shutil.which("bash") and PROGRAM.exists()), reason="bash and the program are needed"
)


def completed(line: str) -> list[str]:
    """Return what bash offers at the end of a line, by the script that the program prints."""
    script = f"""
        eval "$("{PROGRAM}" --show-completion bash)"
        COMP_WORDS=({line}) COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
        _roundelay_completion "{PROGRAM}"
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    done = subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, check=True, env=os.environ
    )
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("roundelay tim", ["timeline"]),
        ("roundelay loop --in-", ["--in-place"]),
        ("roundelay loop --for un", ["unity", "unreal"]),
        ("roundelay loop --for unknown", []),
    ],
)
def test_what_bash_offers(line: str, offered: list[str]) -> None:
    assert completed(line) == offered
