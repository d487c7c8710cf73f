"""Stored languages: what is cached of their documents is limited by these."""

from __future__ import annotations

import httpx
import pytest

from app.api.routes.languages import checks
from app.api.services import language_responses, stored_languages
from app.api.services.language_documents import draft_of
from app.api.services.stored_languages import language_of
from app.recognition import Language
from tests.api.running import Running


def test_cached_languages_are_limited_by_their_documents(
    server: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    states = [
        server.studio.languages.create(draft_of(Language(name=name * 70), "made")) for name in "abc"
    ]
    size = len(states[0].revision.document)
    monkeypatch.setattr(stored_languages, "MOST_CACHED_CHARACTERS", 2 * size)
    first = language_of(states[0])
    assert language_of(states[0]) is first
    language_of(states[1])
    assert language_of(states[0]) is first
    for state in states[1:]:
        language_of(state)
    assert language_of(states[0]) is not first
    monkeypatch.setattr(stored_languages, "MOST_CACHED_CHARACTERS", 1)
    long = language_of(states[2])
    assert language_of(states[2]) is long


def test_what_is_told_of_languages_keeps_no_more_of_their_documents(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stored_languages, "MOST_CACHED_CHARACTERS", 1)
    for name in ("pool", "sea", "lake"):
        made = client.post("/api/v1/languages", json={"name": name}).json()
        place = f"/api/v1/languages/{made['id']}"
        assert client.get(f"{place}/phrases").status_code == 200
        assert len(client.get(place).json()["sha256"]) == 64
    assert len(language_responses._checksums) == len(checks._ambiguities) == 1
