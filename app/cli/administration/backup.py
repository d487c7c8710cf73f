"""Commands ``osg-studio backup`` and ``restore``: save a data folder, and restore it anywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.administration.data_folder import DataDir, audit_of, settings_of
from app.cli.terminal import people
from app.recognition.errors import OsgError


def backup(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File to write.")],
    data_dir: DataDir = None,
) -> None:
    """Write database, clips and keypoints to one file, also while the studio runs."""
    settings = settings_of(data_dir)
    from app.store import StoreError
    from app.store.backup import write_backup
    from app.store.objects import open_object_store

    try:
        objects = open_object_store(settings.objects)
        clips = write_backup(
            settings.data_dir,
            file.absolute(),
            clips=settings.clips,
            objects=objects,
            url=settings.database_url,
        )
        with audit_of(settings) as note:
            note("backup", str(file.absolute()))
    except StoreError as error:
        raise OsgError(str(error)) from error
    people.print(f"{clips} clips and all languages are in {file}", markup=False, highlight=False)


def restore(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File that `backup` wrote.")],
    data_dir: DataDir = None,
) -> None:
    """Restore a backup into a data folder or database that is empty; every file is verified."""
    settings = settings_of(data_dir)
    from app.store import StoreError
    from app.store.backup import restore_backup
    from app.store.objects import open_object_store

    try:
        objects = open_object_store(settings.objects)
        clips = restore_backup(
            file,
            settings.data_dir,
            clips=settings.clips,
            objects=objects,
            url=settings.database_url,
        )
        with audit_of(settings) as note:
            note("restore", str(file.absolute()))
    except StoreError as error:
        raise OsgError(str(error)) from error
    place = "the database of OSG_DATABASE_URL" if settings.database_url else settings.data_dir
    people.print(f"{clips} clips and all languages are in {place}", markup=False, highlight=False)
