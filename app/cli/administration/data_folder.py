"""Option ``--data-dir`` of the commands that work on a studio's data folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.recognition.errors import OsgError

if TYPE_CHECKING:
    from app.settings import Settings

DataDir = Annotated[Path | None, typer.Option(help="Folder for clips, languages and the database.")]


def settings_of(given: Path | None) -> Settings:
    """Return the settings, with the folder named.

    Raises
    ------
    OsgError
        When only a robot's packages are installed.

    """
    try:
        from app.settings import Settings
    except ModuleNotFoundError as error:
        raise OsgError(
            f"the studio's packages are not installed ({error.name} is missing), and only the "
            "studio has a data folder"
        ) from error
    return Settings() if given is None else Settings(data_dir=given)
