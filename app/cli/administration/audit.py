"""Command ``osg-studio audit``: who changed what in a studio, and when."""

from __future__ import annotations

import json
from contextlib import closing
from typing import Annotated

import typer

from app.cli.administration.data_folder import DataDir, settings_of
from app.recognition.errors import OsgError


def audit(
    limit: Annotated[int, typer.Option(min=1, max=1000, help="Most changes to list.")] = 100,
    name: Annotated[str | None, typer.Option(help="Only those of this name.")] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object a line instead.")
    ] = False,
    data_dir: DataDir = None,
) -> None:
    """List the changes in a studio by time, name, address and path, the newest first."""
    settings = settings_of(data_dir)
    from app.store import AuditStore, Database, StoreError

    if settings.database_url is None and not (settings.data_dir / "studio.db").is_file():
        raise OsgError(f"{settings.data_dir} holds no studio; give its folder with --data-dir")
    try:
        with closing(Database(settings.database)) as database:
            entries = AuditStore(database, settings.data_dir).newest(limit, name=name)
    except StoreError as error:
        raise OsgError(str(error)) from error
    for entry in entries:
        content = entry.model_dump(mode="json")
        if as_json:
            typer.echo(json.dumps(content))
        else:
            keys = ("time", "name", "role", "address", "method", "path", "status")
            typer.echo("\t".join(str(content[key]) for key in keys))
