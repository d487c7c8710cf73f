"""Invitations in tests: making one, and sending takes whose poses are known."""

from __future__ import annotations

from typing import Any

import httpx

from app.api.services.running_studio import Studio
from app.recognition import Recording
from app.store import InvitedTake
from tests.api.languages import LANGUAGES
from tests.api.recordings import add_recorded_clip
from tests.api.running import Running, client_of, until

INVITED = "/api/v1/invited"


def client_with(server: Running, token: str) -> httpx.Client:
    return client_of(server.address, headers={"Authorization": f"Bearer {token}"})


def invite(client: httpx.Client, language_id: str, **limits: int) -> dict[str, Any]:
    answer = client.post(f"{LANGUAGES}/{language_id}/invitations", json=limits)
    assert answer.status_code == 201, answer.text
    made: dict[str, Any] = answer.json()
    return made


def token_of(made: dict[str, Any]) -> str:
    return str(made["link"]).partition("#")[2]


def show(
    studio: Studio,
    made: dict[str, Any],
    recording: Recording,
    *,
    label: str = "circle",
    diver: str = "Bo",
) -> InvitedTake:
    """Send a take whose poses are known, and return it once it is judged."""
    take = studio.invitations.receive(made["id"], label=label, diver=diver, size=1024)
    add_recorded_clip(studio, recording, clip_id=take.clip_id)
    until(lambda: studio.invitations.take(made["id"], take.id).status != "waiting")
    return studio.invitations.take(made["id"], take.id)


def divers_of(client: httpx.Client, language_id: str, label: str) -> list[str]:
    place = f"{LANGUAGES}/{language_id}/demonstrations"
    return [each["diver"] for each in client.get(place, params={"label": label}).json()]
