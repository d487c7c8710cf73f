"""Asked revisions: what every route that reads a language in one of its revisions receives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

from fastapi import Depends

from app.api.http.revisions import Revision
from app.api.services.running_studio import CurrentStudio, Studio
from app.recognition import Language
from app.store import LanguageState


@dataclass(frozen=True)
class AskedRevision:
    """The revision of a language that a request asks for.

    Attributes
    ----------
    studio
        Running studio.
    language_id
        Id of the language.
    number
        Number of the revision; None for the newest one.

    """

    studio: Studio
    language_id: str
    number: int | None

    @cached_property
    def state(self) -> LanguageState:
        """The revision as it is stored; NotFound without such a language or revision."""
        return self.studio.languages.get(self.language_id, self.number)

    @property
    def language(self) -> Language:
        """The language that it holds."""
        return self.studio.language(self.state)


async def _asked_of(
    studio: CurrentStudio, language_id: str, revision: Revision = None
) -> AskedRevision:
    return AskedRevision(studio, language_id, revision)


CurrentRevision = Annotated[AskedRevision, Depends(_asked_of)]
"""Type of a route's parameter that receives the revision that a request asks for."""
