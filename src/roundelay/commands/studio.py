"""``roundelay studio``: the local web application."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.base.texts import shown
from roundelay.commands.common import echo, one_line_errors

if TYPE_CHECKING:
    from roundelay.studio.server import Address

Home = Annotated[
    Path, typer.Argument(metavar="FOLDER", help="Where takes and work are kept; made if need be.")
]
Port = Annotated[
    int, typer.Option("--port", min=0, max=65535, help="Port on this machine; 0 for a free one.")
]
Largest = Annotated[
    float,
    typer.Option("--largest", min=1, max=2000, help="Largest file that may be dropped (MB)."),
]
Browser = Annotated[bool, typer.Option("--browser/--no-browser", help="Open the browser.")]


def studio(
    folder: Home = Path("studio"), port: Port = 0, largest: Largest = 256.0, browser: Browser = True
) -> None:
    """Open the studio in the browser: drop a take, mend what was found, get its loops.

    A server for this machine alone, until Ctrl-C. What is dropped is copied into FOLDER, and the
    work on it is kept beside it as NAME.work.json, which opens again and which `loop --work` runs
    without a browser. Nothing leaves the machine.

    Exit code 0: it was closed; 2: bad input.
    """
    with one_line_errors():
        missing = [name for name in ("starlette", "uvicorn") if not importlib.util.find_spec(name)]
        if missing:
            raise ValueError(
                f"expected the library {missing[0]} for the studio, found none: install "
                "roundelay[studio]"
            )
        from roundelay.studio.server import served

        def opened(address: Address, home: Path) -> None:
            echo(f"The studio is open at {address.url}")
            echo(f"Takes and work are kept in {shown(home)}; Ctrl-C closes the studio.")
            if browser:
                typer.launch(address.url)

        served(folder, port=port, largest=largest, opened=opened)
