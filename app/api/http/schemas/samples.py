"""Schemas of the samples that come with the program."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from app.api.http.schemas.values import Body, View


class SampleView(View):
    """A clip that comes with the program."""

    name: str
    size: int
    """Bytes."""


class SampleLanguageView(View):
    """A language that comes with the program."""

    name: str
    """By which it is asked for."""
    title: str
    """The language's own name."""
    labels: list[str]


class SampleChoice(Body):
    """Which sample to add."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
