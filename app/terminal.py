"""What the command line shows a person: progress, vote tables, errors; all on stderr."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from app.recognition import Recognition, Take

people = Console(stderr=True)
"""Where text for people goes; stdout is for data."""


def show_recognition(take: Take, result: Recognition) -> None:
    """Print the label on stdout and the vote table, for a person, on stderr."""
    typer.echo(f"{take.start:.2f}\t{take.end:.2f}\t{result.label}\t{result.confidence:.2f}")
    table = Table(title="distance of every voter to every gesture; * its vote")
    table.add_column("voter")
    for label in result.gestures:
        table.add_column(label, justify="right")
    for voter, distances in zip(result.voters, result.distances, strict=True):
        chosen = result.votes[voter]
        cells = [
            f"{distance:.3g}{' *' if label == chosen else ''}"
            for label, distance in zip(result.gestures, distances, strict=True)
        ]
        table.add_row(voter, *cells)
    people.print(table)


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[..., None]]:
    """Show a bar on stderr (nothing where stderr is no terminal) and give what advances it."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=people, transient=True, disable=not people.is_terminal) as bar:
        task = bar.add_task(title, total=None)

        def advance(done: int, total: int | None, stage: str = "") -> None:
            bar.update(task, completed=done, total=total, description=stage or title)

        yield advance


def describe(error: Exception) -> str:
    """Put an error into one line; a file system's error names its file first."""
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}; check the path and its permissions"
    return " ".join(str(error).split())
