"""Commands ``osg-studio backup`` and ``restore``: keep a data folder, and move it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.administration.data_folder import DataDir, settings_of
from app.cli.terminal import people
from app.recognition.errors import OsgError


def backup(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File to write.")],
    data_dir: DataDir = None,
) -> None:
    """Write database, clips and keypoints to one file, also while the studio runs."""
    folder = _data_dir(data_dir)
    from app.store.backup import write_backup

    clips = write_backup(folder, file.absolute())
    people.print(f"{clips} clips and all languages are in {file}", markup=False, highlight=False)


def restore(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File that `backup` wrote.")],
    data_dir: DataDir = None,
) -> None:
    """Restore a backup into a data folder that is empty; every file is verified."""
    folder = _data_dir(data_dir)
    from app.store.backup import restore_backup

    clips = restore_backup(file, folder)
    people.print(f"{clips} clips and all languages are in {folder}", markup=False, highlight=False)


def _data_dir(given: Path | None) -> Path:
    """Return the folder named, or that of the settings, whose database must be in it."""
    settings = settings_of(given)
    if settings.database_url is not None:
        raise OsgError(
            "OSG_DATABASE_URL names another database, which its own tools back up; copy the "
            "folder of the clips beside it"
        )
    return settings.data_dir
