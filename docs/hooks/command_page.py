"""The commands of `osg-studio`, from the Typer application."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer
from tables import cell, table

from app.cli.application import command_line as application

NAME = "osg-studio"


def command_line() -> str:
    """Return every command with its usage, arguments and options."""
    return "\n".join(_sections(typer.main.get_command(application), None, NAME))


def _sections(command: Any, parent: Any, name: str) -> Iterator[str]:
    context = typer.Context(command, parent=parent, info_name=name)
    usage = " ".join(command.get_usage(context).removeprefix("Usage: ").split())
    yield f"## {context.command_path}\n"
    yield f"{command.help or ''}\n"
    yield f"```text\n{usage}\n```\n"
    records = (
        parameter.get_help_record(context)
        for parameter in command.get_params(context)
        if parameter.name != "help"
    )
    rows = [
        (f"`{names.replace('|', ' or ')}`", cell(text)) for names, text in filter(None, records)
    ]
    if rows:
        yield table(["argument or option", "meaning"], rows)
    for word, child in getattr(command, "commands", {}).items():
        yield from _sections(child, context, word)
