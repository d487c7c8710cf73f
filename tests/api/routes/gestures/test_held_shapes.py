"""Held hand shapes over HTTP: authored, shown, recognised and explained as movements are."""

from pathlib import Path

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.recognition import Recording
from app.recognition.features.png import decode_png
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip

SIGNS = Path(__file__).parents[3] / "sign_recordings"


def add_sign(studio: Studio, name: str) -> str:
    return add_recorded_clip(studio, Recording.load(SIGNS / f"{name}.npz"), f"{name}.mp4")


@pytest.fixture
def signs(client: httpx.Client, studio: Studio, language_id: str, circle_clip: str) -> str:
    """Return the id of a language of a movement and two held shapes."""
    assert add_gesture(client, language_id, circle_clip).status_code == 201
    for label in ("ok", "two"):
        saved = add_gesture(client, language_id, add_sign(studio, f"{label}-1"), label)
        assert saved.status_code == 201
    return language_id


def test_a_held_shape_is_previewed_and_saved_as_a_hand(
    client: httpx.Client, studio: Studio, signs: str
) -> None:
    where = {"clip_id": add_sign(studio, "stop-1")}
    body = {"label": None, "change": {"demonstration": where}}
    preview = client.post(f"{LANGUAGES}/{signs}/preview", json=body).json()
    assert (preview["problem"], preview["salient"]) == (None, [])
    outlook = client.post(f"{LANGUAGES}/{signs}/preview/health", json=body).json()
    assert outlook["nearest"] is not None
    assert "does not move" in outlook["switches"]["tempo"]["words"]
    (_, gesture, _) = client.get(f"{LANGUAGES}/{signs}").json()["gestures"]
    assert (gesture["label"], gesture["salient"], gesture["has_trajectory"]) == ("ok", [], True)
    assert decode_png(client.get(gesture["thumbnail"]).content, (224, 224)).any()
    assert client.get(f"{gesture['thumbnail']}&marks=true").status_code == 200


def test_a_language_of_both_kinds_has_slate_report_contrast_and_export(
    client: httpx.Client, signs: str
) -> None:
    place = f"{LANGUAGES}/{signs}"
    assert client.get(f"{place}/slate.pdf").status_code == 200
    assert client.get(f"{place}/export/contents").json()["salient"] == ["right_wrist"]
    pair = {"one": "ok", "other": "two"}
    assert client.get(f"{place}/contrast", params=pair).json()["alignment"] is None
