"""The command line: ``roundelay COMMAND``. Each command lives in `roundelay.commands`."""

from __future__ import annotations

import sys
from typing import Annotated, Any, NoReturn, cast

import typer
from typer.core import TyperCommand, TyperGroup

from roundelay.commands.blend import blend, transition
from roundelay.commands.check import check
from roundelay.commands.close import close
from roundelay.commands.common import BAD_INPUT, INTERRUPTED, one_line_errors
from roundelay.commands.compare import compare
from roundelay.commands.convert import convert
from roundelay.commands.excitations import excitations
from roundelay.commands.info import info
from roundelay.commands.inspect import inspect
from roundelay.commands.library import library
from roundelay.commands.listing import filled
from roundelay.commands.loop import loop
from roundelay.commands.name import name
from roundelay.commands.query import query
from roundelay.commands.report import report
from roundelay.commands.reproduce import reproduce
from roundelay.commands.retarget import retarget
from roundelay.commands.search import search
from roundelay.commands.segment import segment
from roundelay.commands.strides import strides
from roundelay.commands.studio import studio
from roundelay.commands.timeline import timeline
from roundelay.commands.vary import vary
from roundelay.commands.view import view

__all__ = ["app"]

# What a wrong command line raises: Typer has no public name for it.
_UsageError: type[Exception] = typer.BadParameter.__mro__[1]


class _Commands(TyperGroup):
    """Commands whose wrong use costs one line, like every other error."""

    def main(self, *args: Any, **options: Any) -> NoReturn:
        try:
            code = super().main(*args, **options | {"standalone_mode": False})
        except _UsageError as error:
            _refuse(error)
        except typer.Abort:
            code = INTERRUPTED
        sys.exit(code)


class _Command(TyperCommand):
    """A command whose help lists what is registered, looked for when the help is shown."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        with one_line_errors():
            for parameter in cast("list[Any]", self.params):
                parameter.help = parameter.help and filled(parameter.help)
        super().format_help(ctx, formatter)


def _refuse(error: Any) -> NoReturn:
    message = error.format_message().rstrip(".")
    where = error.ctx.command_path if error.ctx else "roundelay"
    typer.echo(f"roundelay: {message[:1].lower()}{message[1:]}; see {where} --help", err=True)
    sys.exit(BAD_INPUT)


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",  # paragraphs are filled to the width of the terminal
    context_settings={"help_option_names": ["-h", "--help"]},
    help="From raw motion capture to seamless, loopable cycles.",
    epilog="[A], [B] and [C] are the papers that README.md names.",
)
for command in (
    loop,
    segment,
    timeline,
    strides,
    compare,
    inspect,
    excitations,
    reproduce,
    view,
    studio,
    blend,
    transition,
    vary,
    retarget,
    library,
    search,
    query,
    name,
    report,
    check,
    close,
    convert,
    info,
):
    app.command(cls=_Command)(command)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"roundelay {version('roundelay')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass
