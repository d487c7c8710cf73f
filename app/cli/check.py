"""The command ``osg-studio check``: the health of a language before the dive."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from app.cli.check_report import health_text
from app.cli.evaluate import Person
from app.cli.terminal import progress_bar
from app.recognition import Language
from app.recognition.health.check import check_health

BELOW_BAR = 1
"""Exit code of a language that should not go to sea like that."""


def check(
    file: Annotated[Path, typer.Argument(metavar="FILE.json", help="Language file.")],
    person: Annotated[
        Person, typer.Option(help="Who will dive: who demonstrated, or another.")
    ] = Person.another,
    seed: Annotated[int, typer.Option(min=0, help="Of the variants.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Predict what will be confused, missed or set off by accident, and what would help.

    The exit code is 1 when anything is below the bar.
    """
    language = Language.load(file)
    with progress_bar("check") as advance:
        report = check_health(
            language,
            person=person.value,
            seed=seed,
            progress=lambda stage, done, total: advance(done, total or None, stage),
        )
    if as_json:
        typer.echo(json.dumps(report.to_dict(), allow_nan=False))
    else:
        typer.echo(health_text(report), nl=False)
    if not report.ok:
        raise typer.Exit(BELOW_BAR)
