"""The trigger of a language over HTTP: poses from clips, undo, and refusals."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.recognition import Language
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip
from tests.api.running import assert_problem
from tests.posed import BELLY, HEAD, posed_recording

CLIPS = "/api/v1/clips"


@pytest.fixture
def clip(studio: Studio) -> str:
    return add_recorded_clip(studio, posed_recording("circle-by-belly"))


@pytest.fixture
def clip_of_two_poses(studio: Studio) -> str:
    return add_recorded_clip(studio, posed_recording("wedge-by-belly-and-head"))


def held(clip_id: str, span: tuple[float, float] = BELLY) -> dict[str, Any]:
    return {"clip_id": clip_id, "start": span[0], "end": span[1]}


def test_a_pose_of_a_clip_finds_the_takes_of_all_clips(
    client: httpx.Client, studio: Studio, language_id: str, clip: str
) -> None:
    other = add_recorded_clip(studio, posed_recording("circle-by-belly-2"))
    place, by = f"{LANGUAGES}/{language_id}", {"language_id": language_id}
    assert client.get(f"{CLIPS}/{clip}/takes", params=by).json() == []
    answer = client.put(f"{place}/trigger", json={"kind": "pose", "start": held(clip)})
    assert answer.status_code == 200, answer.text
    language = answer.json()
    assert language["trigger"]["kind"] == "pose"
    assert language["trigger_words"].endswith("(left hand before the body)")
    assert language["change"] == f"Find takes {language['trigger_words']}"
    (take,) = client.get(f"{CLIPS}/{clip}/takes", params=by).json()
    assert take["closed"]
    assert client.get(f"{CLIPS}/{clip}/takes").json() == []
    curve = client.get(f"{CLIPS}/{clip}/timeline", params=by).json()["salute"]
    assert max(curve) > 0.9 > 0.1 > max(client.get(f"{CLIPS}/{clip}/timeline").json()["salute"])
    add_gesture(client, language_id, clip, "circle")
    (gesture,) = client.get(place).json()["gestures"]
    assert (gesture["source"]["start"], gesture["source"]["salutes"]) == (take["start"], 0)
    asked = {"clip_id": other, "language_id": language_id}
    answer = client.post("/api/v1/recognitions", json=asked).json()
    assert (answer["label"], answer["nearest"]) == ("circle", "circle")
    exported = client.get(f"{place}/export", params={"format": "osg-studio"}).content
    assert Language.from_json(exported).trigger.kind == "pose"


def test_another_pose_ends_takes_and_undo_brings_the_salute_back(
    client: httpx.Client, language_id: str, clip: str, clip_of_two_poses: str
) -> None:
    place, by = f"{LANGUAGES}/{language_id}", {"language_id": language_id}
    client.put(f"{place}/trigger", json={"kind": "pose", "start": held(clip)}).raise_for_status()
    draft = {"kind": "pose", "stop": held(clip_of_two_poses, HEAD)}
    language = client.put(f"{place}/trigger", json=draft).json()
    assert None not in (language["trigger"]["start"], language["trigger"]["stop"])
    (take,) = client.get(f"{CLIPS}/{clip_of_two_poses}/takes", params=by).json()
    assert take["closed"]
    words = client.get(f"{place}/comparison", params={"older": 1, "newer": 3}).json()["words"]
    assert words == [f"takes were found between two salutes, are {language['trigger_words']}"]
    client.post(f"{place}/revert", json={"revision": 1}).raise_for_status()
    assert client.get(place).json()["trigger"] is None


def test_without_a_trigger_gestures_are_spotted(
    client: httpx.Client, language_id: str, clip: str
) -> None:
    place, by = f"{LANGUAGES}/{language_id}", {"language_id": language_id}
    client.put(f"{place}/trigger", json={"kind": "none"}).raise_for_status()
    assert client.get(f"{CLIPS}/{clip}/takes", params=by).json() == []
    range_ = {"clip_id": clip, "start": 2.6, "end": 4.4, "label": "circle"}
    client.post(f"{place}/gestures", json=range_).raise_for_status()
    (take,) = client.get(f"{CLIPS}/{clip}/takes", params=by).json()
    assert take["start"] < 3 < 4 < take["end"]


def test_a_gesture_of_the_language_may_begin_and_end_takes(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    place = f"{LANGUAGES}/{language_id}"
    draft = {"kind": "gesture", "start_label": "circle"}
    assert_problem(client.put(f"{place}/trigger", json=draft), 422, "language_invalid")
    add_gesture(client, language_id, circle_clip, "circle")
    language = client.put(f"{place}/trigger", json=draft).json()
    assert language["trigger_words"] == "between the gestures 'circle' and 'circle'"
    removed = client.delete(f"{place}/gestures", params={"label": "circle"})
    assert_problem(removed, 409, "gesture_needed")


@pytest.mark.parametrize(
    ("draft", "pointer", "reason"),
    [
        ({"kind": "pose"}, "/start", "needs a start pose"),
        ({"kind": "pose", "start": (3.0, 4.0)}, "/start", "never still"),
        ({"kind": "pose", "start": (6.55, 7.2)}, "/start", "arms hang"),
        ({"kind": "pose", "start": (90.0, 91.0)}, "/start", "no frames lie between"),
        ({"kind": "pose", "start": BELLY, "stop": BELLY}, "/stop", "too much alike"),
        ({"kind": "none", "start": BELLY}, "/start", "has no poses"),
    ],
)
def test_a_trigger_that_is_none_is_refused(
    client: httpx.Client,
    language_id: str,
    clip: str,
    draft: dict[str, Any],
    pointer: str,
    reason: str,
) -> None:
    body = {key: value if key == "kind" else held(clip, value) for key, value in draft.items()}
    answer = client.put(f"{LANGUAGES}/{language_id}/trigger", json=body)
    problem = assert_problem(answer, 422, "trigger_unusable")
    assert problem["errors"] == [{"pointer": pointer, "detail": problem["detail"]}]
    assert reason in str(problem["detail"])
    assert client.get(f"{LANGUAGES}/{language_id}").json()["revision"] == 1


def test_a_trigger_needs_its_language_its_clip_and_the_newest_revision(
    client: httpx.Client, language_id: str, clip: str
) -> None:
    place = f"{LANGUAGES}/{language_id}/trigger"
    draft = {"kind": "pose", "start": held("none")}
    assert_problem(client.put(place, json=draft), 404, "not_found")
    assert_problem(client.put(f"{LANGUAGES}/none/trigger", json={"kind": "none"}), 404, "not_found")
    late = client.put(place, json={"kind": "none"}, headers={"If-Match": '"7"'})
    assert late.status_code == 412
    asked = {"language_id": "none"}
    for part in ("takes", "timeline"):
        assert_problem(client.get(f"{CLIPS}/{clip}/{part}", params=asked), 404, "not_found")
    assert client.put(place, json={"kind": "wave"}).status_code == 422
