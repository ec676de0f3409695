"""The tasks of the documentation run as they stand, in few lines and by public names."""

import re
from pathlib import Path

import pytest

import roundelay as rl
from roundelay import synth

TEXT = (Path(__file__).parent.parent / "docs" / "tasks.md").read_text()
TASKS = dict(re.findall(r"## (.+?)\n\n```python\n(.*?)```", TEXT, flags=re.S))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("tasks")
    takes = (("walk", synth.steps(8, spread=0.03, fps=60.0, rng=1).motion),)
    takes += tuple(
        (name, synth.varied(8, rng=k).motion) for k, name in enumerate(("before", "after"))
    )
    for name, motion in takes:
        rl.write(motion, found / f"{name}.bvh")
    return found


def test_there_are_five():
    assert len(TASKS) == 5


@pytest.mark.parametrize("name", TASKS)
def test_a_task_runs_in_few_lines(name, folder, monkeypatch, capsys):
    code = TASKS[name]
    assert len([line for line in code.splitlines() if line.strip()]) <= 15
    assert not re.search(r"\b_|\._", code)
    monkeypatch.chdir(folder)
    exec(compile(code, name, "exec"), {})
    written = ("knee.png",) if "knee" in name else ()
    assert capsys.readouterr().out or all((folder / one).exists() for one in written)
