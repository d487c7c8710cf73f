"""Command ``osg-studio samples``: copies the sample languages and clips out of the package."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Annotated

import typer

from app.cli.terminal import people
from app.recognition.errors import OsgError
from app.resources import samples_dir


def samples(
    folder: Annotated[Path, typer.Argument(help="Folder to write; must not exist.")] = Path(
        "languages"
    ),
) -> None:
    """Copy the sample languages and their clips to a folder, to try the commands with."""
    if folder.exists():
        raise OsgError(f"{folder} is there already; give the name of a folder that is not")
    source = samples_dir()
    (folder / "clips").mkdir(parents=True)
    for file in (*sorted(source.glob("*.json")), *sorted((source / "clips").glob("*.mp4"))):
        shutil.copyfile(file, folder / file.relative_to(source))
    people.print(f"{folder}: sample languages, and their clips in {folder / 'clips'}", markup=False)
