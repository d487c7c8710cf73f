"""Command `code`: the short code of a language file, to compare with the robot's."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.terminal import people
from app.recognition.language.short_code import short_code
from app.robot.active_language import ActiveLanguage


def code(
    language: Annotated[Path, typer.Argument(help="Language file (.json)")],
) -> None:
    """Print the code of a language file: the studio and the robot that has it show the same."""
    active = ActiveLanguage.load(language)
    people.print(f"{active.name}, revision {active.revision}", markup=False)
    typer.echo(short_code(active.sha256))
