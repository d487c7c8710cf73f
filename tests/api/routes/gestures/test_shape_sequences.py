"""Sequences of two held hand shapes over HTTP: saved, shown, recognised and explained as one."""

from __future__ import annotations

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.recognition.features.png import decode_png
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip
from tests.recognition.held_takes import FIST, FLAT, TWO, between_salutes, follow, hold
from tests.recognition.parametric_hand import Fingers


def add_clip(studio: Studio, *shapes: Fingers, seed: int = 0) -> str:
    """Store a clip of hand shapes one after the other between two salutes; return its id."""
    takes = (hold(shape, frames=30, seed=seed + n) for n, shape in enumerate(shapes))
    return add_recorded_clip(studio, between_salutes(follow(*takes)))


@pytest.fixture
def signs(client: httpx.Client, studio: Studio, language_id: str) -> str:
    """Return the id of a language of a sequence and its two shapes."""
    for label, shapes in (("stop, hold", (FLAT, FIST)), ("stop", (FLAT,)), ("hold", (FIST,))):
        saved = add_gesture(client, language_id, add_clip(studio, *shapes), label)
        assert saved.status_code == 201, saved.text
    return language_id


def test_a_sequence_is_previewed_and_saved_with_a_picture_of_both_shapes(
    client: httpx.Client, studio: Studio, signs: str
) -> None:
    where = {"clip_id": add_clip(studio, FIST, TWO)}
    body = {"label": None, "change": {"demonstration": where}}
    preview = client.post(f"{LANGUAGES}/{signs}/preview", json=body).json()
    assert (preview["problem"], preview["salient"], preview["held_shapes"]) == (None, [], 2)
    outlook = client.post(f"{LANGUAGES}/{signs}/preview/health", json=body).json()
    assert outlook["nearest"] is not None
    gestures = client.get(f"{LANGUAGES}/{signs}").json()["gestures"]
    assert [each["held_shapes"] for each in gestures] == [2, 1, 1]
    assert gestures[0]["demonstrations"][0]["held_shapes"] == 2
    picture = decode_png(client.get(gestures[0]["thumbnail"]).content, (224, 224))
    assert picture[:, :80].any()
    assert picture[:, -80:].any()


def test_a_language_with_a_sequence_has_slate_report_and_contrast(
    client: httpx.Client, signs: str
) -> None:
    place = f"{LANGUAGES}/{signs}"
    assert client.get(f"{place}/slate.pdf").status_code == 200
    assert client.get(f"{place}/check").status_code in (200, 202)
    pair = {"one": "stop, hold", "other": "stop"}
    assert client.get(f"{place}/contrast", params=pair).json()["alignment"] is None
