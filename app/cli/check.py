"""Command ``osg-studio check``: runs the health check of a language."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from app.cli.check_report import format_report
from app.cli.terminal import progress_bar
from app.recognition import Language
from app.recognition.health.check import check_health
from app.resources import known_signs_file

HAS_ERRORS = 1
"""Exit code when the report has an error."""


def check(
    file: Annotated[Path, typer.Argument(metavar="FILE.json", help="Language file.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Check a language before the dive: what others will reach, and what is wrong.

    The exit code is 1 when the report has an error.
    """
    language = Language.load(file)
    with progress_bar("check") as advance:
        report = check_health(
            language,
            progress=lambda stage, done, total: advance(done, total or None, stage),
            known_signs=Language.load(known_signs_file()),
        )
    if as_json:
        typer.echo(json.dumps(report.to_dict(), allow_nan=False))
    else:
        typer.echo(format_report(report), nl=False)
    if not report.ok:
        raise typer.Exit(HAS_ERRORS)
