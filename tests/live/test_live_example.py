"""The example with a socket runs, and draws what it says."""

import runpy
import sys
from pathlib import Path

EXAMPLE = Path(__file__).parents[2] / "examples" / "live_phase.py"


def test_a_walk_is_followed_over_a_socket(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE), str(tmp_path)])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    said = capsys.readouterr().out
    assert "left contact in" in said
    # Frames that a busy computer loses are few.
    assert int(said.splitlines()[-1].split()[0]) > 250
    assert (tmp_path / "live_phase.png").stat().st_size > 5000
