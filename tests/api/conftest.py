"""The real app on a real port, with a store and samples of the test's own."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.api.services import invited_takes
from app.api.services.running_studio import Studio
from app.settings import Settings
from tests.api.invitations import client_with, invite, token_of
from tests.api.languages import add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import Running, client_of, running
from tests.recognition.damaged_clips import write_clip


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_dir=tmp_path / "data", samples_dir=tmp_path / "samples")


@pytest.fixture
def judged_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a server look for takes of invited divers ten times a second."""
    monkeypatch.setattr(invited_takes, "LOOK_SECONDS", 0.1)


@pytest.fixture
def server(settings: Settings) -> Iterator[Running]:
    with running(settings) as server:
        yield server


@pytest.fixture
def client(server: Running) -> Iterator[httpx.Client]:
    with client_of(server.address) as client:
        yield client


@pytest.fixture
def studio(server: Running) -> Studio:
    return server.studio


@pytest.fixture
def circle_clip(studio: Studio) -> str:
    """Return the id of a clip with one take, a circle."""
    return add_recorded_clip(studio, recording_of("circle"))


@pytest.fixture
def line_clip(studio: Studio) -> str:
    """Return the id of a clip with one take, a line."""
    return add_recorded_clip(studio, recording_of("line"))


@pytest.fixture
def language_id(client: httpx.Client) -> str:
    """Return the id of an empty language."""
    answer = client.post("/api/v1/languages", json={"name": "pool"})
    assert answer.status_code == 201
    return str(answer.json()["id"])


@pytest.fixture
def small_clip(tmp_path: Path) -> Path:
    """Return a clip of twelve frames without a person."""
    return write_clip(tmp_path / "small.mp4")


@pytest.fixture
def pool(client: httpx.Client, language_id: str, circle_clip: str, line_clip: str) -> str:
    """Return the id of a language of a circle and a line, shown by one person."""
    for clip, label in ((circle_clip, "circle"), (line_clip, "line")):
        assert add_gesture(client, language_id, clip, label).status_code == 201
    return language_id


@pytest.fixture
def made(client: httpx.Client, pool: str) -> dict[str, Any]:
    return invite(client, pool)


@pytest.fixture
def guest(server: Running, made: dict[str, Any]) -> Iterator[httpx.Client]:
    """Return the client of somebody who was invited."""
    with client_with(server, token_of(made)) as guest:
        yield guest
