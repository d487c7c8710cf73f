"""Application `osg-studio`: defines the commands and turns errors into exit codes.

Text for people goes to stderr, data to stdout. Exit codes: 0 done, 1 nothing was recognised or the
check found an error, 2 bad use or bad input, with one line that names cause and next step, 3 the
program failed, with a traceback, 4 a robot went on without a log that it could not write.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Sequence
from functools import cache
from typing import Annotated, Any, NoReturn

import typer
from pydantic import ValidationError
from typer.main import get_command

from app import __version__
from app.cli.administration import DataDir, audit, backup, models_command, restore, tokens_command
from app.cli.check import check
from app.cli.demonstrations import define, demonstrations_command, trigger
from app.cli.evaluate import evaluate
from app.cli.extract import extract
from app.cli.language_files import code, convert, phrase, samples, slate
from app.cli.recognize import recognize
from app.cli.robots.robot import robot, split_ros_arguments
from app.cli.terminal import describe_error
from app.recognition.errors import OsgError, explain_missing_package
from app.system.confinement import hide_memory

BAD_INPUT = 2
CRASHED = 3

_build_command = cache(get_command)
"""Cached, because the tests run it a thousand times."""

command_line = typer.Typer(
    name="osg-studio",
    help="Design gesture languages for underwater robots: one demonstration per gesture.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
command_line.add_typer(models_command, name="models")
command_line.add_typer(demonstrations_command, name="demonstrations")
command_line.add_typer(tokens_command, name="tokens")


@command_line.callback(invoke_without_command=True)
def top(
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Handle options before any command."""
    if version:
        typer.echo(__version__)
        raise typer.Exit


def serve(
    host: Annotated[
        str, typer.Option(envvar="OSG_HOST", help="Address to listen on.")
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(envvar="OSG_PORT", help="Port to listen on; 0 picks a free one.")
    ] = 8000,
    data_dir: DataDir = None,
    token: Annotated[
        str | None,
        typer.Option(
            envvar="OSG_TOKEN", help="Secret that every visitor needs; required off loopback."
        ),
    ] = None,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Do not open a browser.")
    ] = False,
) -> None:
    """Start the studio and open it in the browser."""
    with explain_missing_package("the studio", "studio", instead=", on Python 3.11 or newer"):
        from app.server import run
        from app.settings import Settings
    given: dict[str, Any] = {"host": host, "port": port, "data_dir": data_dir, "token": token}
    try:
        settings = Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        raise OsgError(error.errors()[0]["msg"].removeprefix("Value error, ")) from error
    # A reader of received files must not find the token in this process's memory.
    hide_memory()
    run(settings, open_browser=not no_browser)


for command in (
    serve, define, recognize, convert, trigger, evaluate, extract, check, code, slate, robot,
    phrase, backup, restore, audit, samples,
):  # fmt: skip
    command_line.command()(command)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit with its code; known errors print one line on stderr."""
    try:
        given = sys.argv[1:] if arguments is None else arguments
        # The other commands refuse ROS arguments like any unknown option.
        own, ros = split_ros_arguments(given) if given[:1] == ["robot"] else (given, [])
        _build_command(command_line)(args=own, prog_name="osg-studio", obj=ros)
    except (OsgError, OSError) as error:
        sys.stderr.write(f"osg-studio: {describe_error(error)}\n")
        sys.exit(BAD_INPUT)
    except Exception:
        # Python's own code of a crash is 1, which also means that nothing was recognised.
        traceback.print_exc()
        sys.exit(CRASHED)
    sys.exit(0)
