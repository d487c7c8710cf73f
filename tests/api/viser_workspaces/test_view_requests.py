"""View requests: the requested view is looked up in the store."""

from pathlib import Path

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.api.viser_workspaces.routes import ViewRequest, view_of
from app.store import Clip, NotFound
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.running import assert_problem


@pytest.fixture
def recognition_id(client: httpx.Client, language_id: str, circle_clip: str) -> str:
    """Return the id of a recognition of a circle, expected to be a square."""
    add_gesture(client, language_id, circle_clip)
    body = {"clip_id": circle_clip, "language_id": language_id, "expected": "square"}
    return str(client.post("/api/v1/recognitions", json=body).json()["id"])


def test_a_recognition_is_shown_with_its_range_and_its_own_revision(
    client: httpx.Client, studio: Studio, language_id: str, circle_clip: str, recognition_id: str
) -> None:
    client.delete(f"{LANGUAGES}/{language_id}/gestures/circle")
    view = view_of(studio, ViewRequest(clip_id=circle_clip, recognition_id=recognition_id))
    kept = client.get(f"/api/v1/recognitions/{recognition_id}").json()
    assert (view.start, view.end) == (kept["start"], kept["end"])
    assert view.expected == "square"
    assert view.language is not None
    assert view.language.labels == ("circle",)
    assert view.recognition is not None
    assert view.recognition.to_dict()["distances"] == kept["distances"]
    assert view.video == studio.clips.video(circle_clip)


def test_a_range_of_ones_own_and_a_language_can_be_asked_for(
    studio: Studio, language_id: str, circle_clip: str
) -> None:
    request = ViewRequest(clip_id=circle_clip, language_id=language_id, start=1.0, end=2.0)
    view = view_of(studio, request)
    assert (view.start, view.end, view.recognition) == (1.0, 2.0, None)
    assert view.language is not None
    assert view_of(studio, ViewRequest(clip_id=circle_clip)).language is None


def test_what_does_not_exist_cannot_be_shown(studio: Studio, circle_clip: str) -> None:
    for request in (
        ViewRequest(clip_id="missing"),
        ViewRequest(clip_id=circle_clip, recognition_id="missing"),
        ViewRequest(clip_id=circle_clip, language_id="missing"),
    ):
        with pytest.raises(NotFound):
            view_of(studio, request)


def test_a_clip_without_poses_cannot_be_shown_yet(
    client: httpx.Client, studio: Studio, tmp_path: Path
) -> None:
    partial = studio.clips.new_partial()
    partial.write_bytes(b"video")
    clip = Clip(name="waiting", media_type="video/mp4", size=5, width=1, height=1)
    studio.clips.add(clip, partial, "test")
    workspace = client.post("/api/v1/workspaces").json()
    address = f"/api/v1/workspaces/{workspace['id']}/view"
    assert_problem(client.put(address, json={"clip_id": clip.id}), 409, "clip_not_ready")
