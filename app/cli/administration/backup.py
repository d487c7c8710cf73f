"""Commands ``osg-studio backup`` and ``restore``: keep a data folder, and move it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.administration.data_folder import DataDir, settings_of
from app.cli.terminal import people
from app.recognition.errors import OsgError

if TYPE_CHECKING:
    from app.settings import Settings


def backup(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File to write.")],
    data_dir: DataDir = None,
) -> None:
    """Write database, clips and keypoints to one file, also while the studio runs."""
    settings = _settings(data_dir)
    from app.store import StoreError
    from app.store.backup import write_backup
    from app.store.objects import open_object_store

    try:
        objects = open_object_store(settings.objects)
        clips = write_backup(
            settings.data_dir, file.absolute(), clips=settings.clips, objects=objects
        )
    except StoreError as error:
        raise OsgError(str(error)) from error
    people.print(f"{clips} clips and all languages are in {file}", markup=False, highlight=False)


def restore(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File that `backup` wrote.")],
    data_dir: DataDir = None,
) -> None:
    """Restore a backup into a data folder that is empty; every file is verified."""
    settings = _settings(data_dir)
    from app.store import StoreError
    from app.store.backup import restore_backup
    from app.store.objects import open_object_store

    folder = settings.data_dir
    try:
        objects = open_object_store(settings.objects)
        clips = restore_backup(file, folder, clips=settings.clips, objects=objects)
    except StoreError as error:
        raise OsgError(str(error)) from error
    people.print(f"{clips} clips and all languages are in {folder}", markup=False, highlight=False)


def _settings(given: Path | None) -> Settings:
    """Return the settings, whose database must be in the data folder."""
    settings = settings_of(given)
    if settings.database_url is not None:
        raise OsgError(
            "OSG_DATABASE_URL names another database, which its own tools back up; copy the "
            "folder of the clips beside it"
        )
    return settings
