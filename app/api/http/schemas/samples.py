"""Schemas of the samples that come with the program."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, Field

from app.api.http.schemas.values import Body


class SampleView(BaseModel):
    """A clip that comes with the program."""

    name: str
    size: int = Field(description="Bytes")


class SampleLanguageView(BaseModel):
    """A language that comes with the program."""

    name: str = Field(description="By which it is asked for")
    title: str = Field(description="The language's own name")
    labels: list[str]


class SampleChoice(Body):
    """Which sample to add."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
