"""Schemas of the table of takes."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, Field

from app.api.http.schemas.values import Body, Identifier

MOST_CLIPS = 500
"""Most clips of one table."""


class TakeTableRequest(Body):
    """Clips whose takes are recognised."""

    id: Identifier = Field(description="Chosen by the client: names its `tables` events")
    clip_ids: Annotated[list[Identifier], Field(min_length=1, max_length=MOST_CLIPS)]


class TakeRowView(BaseModel):
    """A take, or a clip without one, as `osg-studio recognize FOLDER --table` writes it."""

    clip_id: str
    clip: str
    take: int | None = Field(description="From 1; null: no take was found, see `faults`")
    start: float | None
    end: float | None
    closed: bool | None
    label: str | None = Field(description="Null: a pair, or rejected")
    nearest: str | None
    runner_up: str | None = Field(description="The nearest gesture but `nearest`")
    confidence: float | None
    margin: float | None
    expected: str | None = Field(description="By the language's test set; null: not in it")
    faults: str
    language: str
    revision: int
    profile: str
    pair: str | None = Field(description='"circle or square"; null: it lies between no two')


class TakeTableView(BaseModel):
    """One row for each take, clip after clip."""

    rows: list[TakeRowView]
    csv: str = Field(description="The same rows as the command line writes them")
