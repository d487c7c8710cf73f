"""Demonstration sources: a gesture keeps the reference to its clip, whatever edits follow."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.store.models import now
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]

CLIPS = "/api/v1/clips"


def source(client: httpx.Client, language_id: str) -> Any:
    (gesture,) = client.get(f"{LANGUAGES}/{language_id}").json()["gestures"]
    return gesture["source"]


@pytest.fixture
def saved(client: httpx.Client, language_id: str, circle_clip: str) -> dict[str, Any]:
    """Return the source recorded for a saved gesture's demonstration."""
    (take,) = client.get(f"{CLIPS}/{circle_clip}/takes").json()
    (gesture,) = add_gesture(client, language_id, circle_clip).json()["gestures"]
    expected = {
        "start": take["start"],
        "end": take["end"],
        "keep_transit": False,
        "salutes": 0,
        "faults": [],
    }
    expected |= {"fault": None}
    assert gesture["source"] == {"clip_id": circle_clip, **expected}
    found: dict[str, Any] = gesture["source"]
    return found


def test_a_new_name_other_words_and_keypoints_change_nothing(
    client: httpx.Client, language_id: str, saved: dict[str, Any]
) -> None:
    change = {"label": "ring", "description": "round", "salient": ["left_wrist", "right_wrist"]}
    client.patch(f"{LANGUAGES}/{language_id}/gestures/circle", json=change)
    assert source(client, language_id) == saved


def test_of_a_deleted_clip_nothing_is_told_until_it_is_restored(
    client: httpx.Client, language_id: str, circle_clip: str, saved: dict[str, Any]
) -> None:
    client.delete(f"{CLIPS}/{circle_clip}")
    assert source(client, language_id) is None
    client.post(f"{CLIPS}/{circle_clip}/restore")
    assert source(client, language_id) == saved


def test_of_a_clip_that_is_gone_for_good_nothing_is_left(
    client: httpx.Client, studio: Studio, language_id: str, circle_clip: str, saved: dict[str, Any]
) -> None:
    assert source(client, language_id) == saved
    client.delete(f"{CLIPS}/{circle_clip}")
    assert studio.clips.purge(now() + timedelta(seconds=1)) == 1
    assert source(client, language_id) is None
    assert add_gesture(client, language_id, circle_clip, "again").status_code == 404
