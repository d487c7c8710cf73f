"""Limited routes: what is computed waits for its turn, and others are answered meanwhile."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from app.api.routes.languages import language_files, languages
from app.api.services.limited_routes import MOST_COMPUTATIONS, MOST_EDITS
from app.recognition import Language
from app.ui.slate.layout import lay_out
from app.ui.slate.primitives import Page
from tests.api.running import PATIENCE_SECONDS, Running, client_of, until


def test_long_computations_of_many_clients_take_turns(
    server: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    at_work, most, free = 0, 0, threading.Event()

    def lay_out_slowly(language: Language) -> Page:
        nonlocal at_work, most
        at_work += 1
        most = max(most, at_work)
        free.wait(PATIENCE_SECONDS)
        at_work -= 1
        return lay_out(language)

    monkeypatch.setattr(language_files, "lay_out", lay_out_slowly)
    with client_of(server.address) as client, ThreadPoolExecutor(8) as others:
        language = client.post("/api/v1/languages", json={"name": "pool"}).json()["id"]
        place = f"/api/v1/languages/{language}/slate.svg"
        answers = [others.submit(client.get, place) for _ in range(8)]
        until(lambda: at_work == MOST_COMPUTATIONS)
        # Others are answered meanwhile.
        assert client.get(f"/api/v1/languages/{language}").status_code == 200
        free.set()
        assert {answer.result().status_code for answer in answers} == {200}
    assert most == MOST_COMPUTATIONS


def test_edits_of_languages_that_wait_take_no_thread(
    server: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    free, made = threading.Event(), list[str]()

    def describe_slowly(fields: Mapping[str, Any]) -> str:
        made.append(fields["author"])
        assert free.wait(PATIENCE_SECONDS)
        return "slow"

    monkeypatch.setattr(languages, "_describe", describe_slowly)
    with client_of(server.address) as client, ThreadPoolExecutor(50) as others:
        language = client.post("/api/v1/languages", json={"name": "pool"}).json()["id"]
        place = f"/api/v1/languages/{language}"
        answers = [
            others.submit(client.patch, place, json={"author": str(number)}) for number in range(50)
        ]
        until(lambda: len(made) == MOST_EDITS)
        # More wait than there are threads, and others are answered meanwhile.
        assert client.get(place).json()["revision"] == 1
        assert len(made) == MOST_EDITS
        free.set()
        assert {answer.result().status_code for answer in answers} == {200}
    assert sorted(made) == sorted(map(str, range(50)))
