"""Hand shapes during a movement over HTTP: two gestures that differ by them alone."""

from __future__ import annotations

from dataclasses import replace

import httpx
import numpy as np
import pytest

from app.api.services.running_studio import Studio
from app.recognition import Recording
from app.recognition.poses.frame import Hand
from app.recognition.poses.landmarks import POSE_LANDMARKS
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.recognition.held_takes import FIST, FLAT
from tests.recognition.parametric_hand import Fingers, hand_xy

PALM = 20.0
"""Length of a palm in pixels."""


def circle_with(shape: Fingers, seed: int) -> Recording:
    """Return a recording of a circle that is drawn with a hand shape."""
    recording = recording_of("circle")
    random = np.random.default_rng(seed)
    points = PALM * hand_xy(shape)
    wrists = recording.poses.xy[:, POSE_LANDMARKS.index("right_wrist")]
    hands = tuple(
        (Hand(wrist + points - points[0] + random.normal(0, 0.4, points.shape), "right", 1.0),)
        for wrist in wrists
    )
    return Recording(replace(recording.poses, hands=None), hands, recording.salute)


@pytest.fixture
def twins(client: httpx.Client, studio: Studio, language_id: str) -> str:
    """Return the id of a language of one circle with two hand shapes."""
    for seed, (label, shape) in enumerate((("fist", FIST), ("flat", FLAT))):
        clip = add_recorded_clip(studio, circle_with(shape, seed), f"{label}.mp4")
        assert add_gesture(client, language_id, clip, label).status_code == 201
        assert switch(client, language_id, label, "on").status_code == 200
    return language_id


def switch(client: httpx.Client, language_id: str, label: str, position: str) -> httpx.Response:
    """Set the switch of the hand shape."""
    place = f"{LANGUAGES}/{language_id}"
    tag = client.get(place).headers["etag"]
    return client.patch(
        f"{place}/gestures/{label}", json={"hand_shape": position}, headers={"If-Match": tag}
    )


def test_the_editor_tells_what_the_switch_comes_to(client: httpx.Client, twins: str) -> None:
    place = f"{LANGUAGES}/{twins}/preview/health"
    words = {}
    for position in ("auto", "on", "off"):
        body = {"label": "fist", "change": {"hand_shape": position}}
        view = client.post(place, json=body).json()["switches"]["hand_shape"]
        words[position] = view["words"]
        assert view["counts"] is (position == "on")
    assert words["auto"] == words["off"]
    assert words["on"] == "the hand must be seen and have this shape while it moves"
    assert words["off"] == "the hand may have any shape"


def test_a_demonstration_without_hands_is_told_where_its_shape_shall_count(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    assert add_gesture(client, language_id, circle_clip).status_code == 201
    body = {"label": "circle", "change": {"hand_shape": "on"}}
    view = client.post(f"{LANGUAGES}/{language_id}/preview/health", json=body).json()["switches"]
    assert view["hand_shape"]["counts"] is False
    assert view["hand_shape"]["words"].startswith("no hand is seen in the demonstration")
