"""Terminal output for people: progress, vote tables and errors, all on stderr."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar

import typer
from rich import box
from rich.console import Console
from rich.measure import Measurement
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from app.recognition import Recognition, Take
from app.recognition.explanation.explanation import Explanation
from app.recognition.text.wording import ask_which, join_words
from app.recognition.triggers.trigger import Trigger

people = Console(stderr=True)
"""Console for text for people; stdout is for data."""


def tell(text: str) -> None:
    """Write a line for people as it is: a path has no markup, and is not broken in two."""
    people.print(text, markup=False, highlight=False, soft_wrap=True)


def show_recognition(take: Take, result: Recognition, trigger: Trigger) -> None:
    """Print the label or the question on stdout, the votes on stderr; `trigger` ends the takes."""
    answer = result.label if result.pair is None else ask_which(result.pair)
    typer.echo(f"{take.start:.2f}\t{take.end:.2f}\t{answer}\t{result.confidence:.2f}")
    if not take.closed:
        tell(
            f"the take from {take.start:.2f} s has no second {trigger.noun}: the gesture may be "
            f"incomplete; give its range by hand, CLIP@{take.start:.2f}-{take.end:.2f}"
        )
    for finding in result.findings:
        tell(f"the take from {take.start:.2f} s: {finding}")
    if result.disagreed:
        tell(f"the take from {take.start:.2f} s: the two ways of comparing disagree")
    if len(result.between) > 2:
        tell(f"the take from {take.start:.2f} s lies between {join_words(result.between)}")
    if result.fault:
        tell(f"the take from {take.start:.2f} s cannot be recognised: {result.fault}")
    table = build_vote_table(result)
    # In a narrow terminal lines wrap; rich would crop them and lose distances.
    unlimited = people.options.update(max_width=10_000)
    needed = Measurement.get(people, unlimited, table).maximum
    Console(stderr=True, width=max(people.width, needed)).print(table)


def show_explanation(explanation: Explanation) -> None:
    """Print an explanation on stderr: why a take was recognised so, and the interventions."""
    people.print(Text(explanation.sentence))
    for line in explanation.details:
        people.print(Text(f"  {line}"))
    title = f"with which {explanation.expected!r} would be recognised"
    table = _create_table(title, "what to change", "confidence", "margin", "known takes")
    for found in explanation.counterfactuals:
        effect = found.effect
        table.add_row(
            Text(found.change.words),
            f"{found.confidence:.2f}",
            f"{found.margin:.2f}",
            ""
            if effect is None or not effect.takes
            else f"{effect.repaired} repaired, {effect.broken} broken of {effect.takes}",
        )
    if table.row_count:
        people.print(table)


def build_vote_table(result: Recognition) -> Table:
    """Build a table of every voter's distance to every gesture, one row per gesture.

    A star marks a vote, a point a vote with weight 0. Gestures are rows because a language has
    many, and the paper's seven voters fit into eighty columns.
    """
    table = _create_table(
        "distance to every gesture, by voter; * its vote, . a vote without weight"
    )
    table.add_column("gesture", vertical="bottom")
    for voter in result.voters:
        table.add_column(voter.replace("_", "\n"), justify="right", vertical="bottom", no_wrap=True)
    for column, label in enumerate(result.gestures):
        cells = [
            f"{distances[column]:.2f}{_mark_vote(result, voter, label)}"
            for voter, distances in zip(result.voters, result.distances, strict=True)
        ]
        table.add_row(Text(label), *cells)
    return table


def _create_table(title: str, *heads: str) -> Table:
    gaps = (0, 1, 0, 0)
    return Table(*heads, title=title, title_justify="left", box=box.SIMPLE_HEAD, padding=gaps)


def _mark_vote(result: Recognition, voter: str, label: str) -> str:
    if result.votes.get(voter) != label:
        return " "
    return "*" if result.weights[voter] > 0 else "."


def _create_bar(*, counted: bool) -> Progress:
    """Create the display of a bar, which shows nothing where there is no terminal."""
    counter = (MofNCompleteColumn(),) if counted else ()
    columns = (TextColumn("{task.description}"), BarColumn(), *counter, TimeRemainingColumn())
    return Progress(*columns, console=people, transient=True, disable=not people.is_terminal)


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[..., None]]:
    """Show a progress bar on stderr, if that is a terminal, and return its update function."""
    bar, outer = _create_bar(counted=True), _batch.get()
    with bar if outer is None else nullcontext(outer) as shown:
        task = shown.add_task(title, total=None)

        def advance(done: int, total: int | None, stage: str = "") -> None:
            shown.update(task, completed=done, total=total, description=stage or title)

        try:
            yield advance
        finally:
            shown.remove_task(task)


_batch: ContextVar[Progress | None] = ContextVar("batch", default=None)
"""Progress display of the running batch; a terminal shows only one at a time."""


@contextmanager
def batch_bar(clips: int, size: int) -> Iterator[Callable[[int, str], None]]:
    """Show a batch on stderr: a line for each clip, and a bar with the time left in a terminal.

    Parameters
    ----------
    clips
        Number of clips.
    size
        Total bytes of the clips, from which the time left is estimated.

    """
    bar, number = _create_bar(counted=False), 0
    with bar:
        task = bar.add_task(f"0 of {clips} clips", total=size)
        token = _batch.set(bar)

        def advance(done: int, line: str) -> None:
            nonlocal number
            number += 1
            bar.update(task, advance=done, description=f"{number} of {clips} clips")
            tell(f"{number}/{clips} {line}")

        try:
            yield advance
        finally:
            _batch.reset(token)


def describe_error(error: Exception) -> str:
    """Describe an error in one line; an error of the file system starts with the file's name."""
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}; check the path and its permissions"
    return " ".join(str(error).split())
