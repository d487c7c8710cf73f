"""Asked revisions: what every route that reads or stores a revision of a language receives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

from fastapi import Depends, Response

from app.api.http.revisions import ExpectedRevision, Revision
from app.api.http.schemas.languages import LanguageView
from app.api.ingest.intake import SenderQuota
from app.api.services.language_responses import announce, save_revision
from app.api.services.running_studio import CurrentStudio, Languages, Studio
from app.api.services.stored_languages import language_of, trigger_of
from app.recognition import Language
from app.recognition.triggers.trigger import Trigger
from app.store import LanguageState, LanguageStore, Quota


@dataclass(frozen=True)
class AskedRevision:
    """The revision of a language that a request asks for.

    Attributes
    ----------
    languages
        The store.
    language_id
        Id of the language.
    number
        Number of the revision; None for the newest one.

    """

    languages: LanguageStore
    language_id: str
    number: int | None = None

    @cached_property
    def state(self) -> LanguageState:
        """The revision as it is stored; NotFound without such a language or revision."""
        return self.languages.get(self.language_id, self.number)

    @property
    def language(self) -> Language:
        """The language that it holds."""
        return language_of(self.state)


async def _asked_of(
    languages: Languages, language_id: str, revision: Revision = None
) -> AskedRevision:
    return AskedRevision(languages, language_id, revision)


async def _newest_of(languages: Languages, language_id: str) -> AskedRevision:
    return AskedRevision(languages, language_id)


CurrentRevision = Annotated[AskedRevision, Depends(_asked_of)]
"""Type of a route's parameter that receives the revision that a request asks for."""

NewestRevision = Annotated[AskedRevision, Depends(_newest_of)]
"""The same where a request asks for a language, and always gets its newest revision."""


@dataclass(frozen=True)
class LanguageEdit:
    """An edit of the language in the address of a request, in the name of its sender.

    Attributes
    ----------
    studio
        Running studio.
    language_id
        Id of the language.
    quota
        Quota of the sender.
    expected
        The revision that the sender changes; None accepts the newest one.
    response
        Response to the request, for its headers.

    """

    studio: Studio
    language_id: str
    quota: Quota
    expected: int | None
    response: Response

    @property
    def trigger(self) -> Trigger:
        """Trigger of the language's newest revision; NotFound without such a language."""
        return trigger_of(self.studio.languages, self.language_id)

    def save(self, words: str, change: Callable[[Language], Language]) -> LanguageState:
        """Store the revision that `change` makes of the newest one, with `words` for its history.

        Raises
        ------
        NotFound, Conflict, QuotaExceeded, StoreUnavailable
            As `LanguageStore.edit`.

        """
        return save_revision(
            self.studio, self.quota, self.language_id, words, change, self.expected
        )

    def answer(self, state: LanguageState) -> LanguageView:
        """Publish that the language changed, and answer with it."""
        return announce(self.studio, state, self.response)


async def _edit_of(
    studio: CurrentStudio,
    language_id: str,
    quota: SenderQuota,
    expected: ExpectedRevision,
    response: Response,
) -> LanguageEdit:
    return LanguageEdit(studio, language_id, quota, expected, response)


CurrentEdit = Annotated[LanguageEdit, Depends(_edit_of)]
"""Type of a route's parameter that receives the edit that a request asks for."""
