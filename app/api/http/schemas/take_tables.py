"""Schemas of the table of takes."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from app.api.http.schemas.values import Body, Identifier, View

MOST_CLIPS = 500
"""Most clips of one table."""


class TakeTableRequest(Body):
    """Clips whose takes are recognised."""

    id: Identifier
    """Chosen by the client: names its `tables` events."""
    clip_ids: Annotated[list[Identifier], Field(min_length=1, max_length=MOST_CLIPS)]


class TakeRowView(View):
    """A take, or a clip without one, as `osg-studio recognize FOLDER --table` writes it."""

    clip_id: str
    clip: str
    take: int | None
    """From 1; null: no take was found, see `faults`."""
    start: float | None
    end: float | None
    closed: bool | None
    label: str | None
    """Null: a pair, or rejected."""
    nearest: str | None
    runner_up: str | None
    """The nearest gesture but `nearest`."""
    confidence: float | None
    margin: float | None
    expected: str | None
    """By the language's test set; null: not in it; ``-``: none of the gestures."""
    faults: str
    language: str
    revision: int
    profile: str
    pair: str | None
    """"circle or square"; null: it lies between no two."""


class TakeTableView(View):
    """One row for each take, clip after clip."""

    rows: list[TakeRowView]
    csv: str
    """The same rows as the command line writes them."""
