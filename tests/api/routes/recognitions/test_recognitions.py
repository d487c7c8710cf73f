"""Recognitions over HTTP: complete, repeatable, and stored."""

import json
from dataclasses import replace

import httpx
import numpy as np
import pytest

from app.api.services.running_studio import Studio
from app.api.services.stored_languages import language_of
from app.api.services.stored_recognitions import locate_cuts
from app.recognition.explanation.counterfactuals import Counterfactual, Intervention
from app.recognition.gestures.profile import PROFILES
from app.store import RecognitionRecord
from tests.api.languages import LANGUAGES, add_ambiguous_language, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem

RECOGNITIONS = "/api/v1/recognitions"


@pytest.fixture
def spoken(client: httpx.Client, language_id: str, circle_clip: str, line_clip: str) -> str:
    """Return the id of a language of a circle and a line."""
    assert add_gesture(client, language_id, circle_clip, "circle").status_code == 201
    assert add_gesture(client, language_id, line_clip, "line").status_code == 201
    return language_id


@pytest.mark.parametrize("shape", ["circle", "line"])
def test_a_take_is_recognised_with_every_voters_distances(
    client: httpx.Client, studio: Studio, spoken: str, shape: str
) -> None:
    clip_id = add_recorded_clip(studio, recording_of(shape))
    body = {"clip_id": clip_id, "language_id": spoken, "expected": shape}
    answer = client.post(RECOGNITIONS, json=body)
    assert answer.status_code == 201
    result = answer.json()
    assert (result["label"], result["expected"]) == (shape, shape)
    assert result["gestures"] == ["circle", "line"]
    voters = PROFILES["full"].voters
    assert result["voters"] == [voter.name for voter in voters]
    assert [len(row) for row in result["distances"]] == [2] * len(voters)
    assert set(result["votes"]) <= set(result["voters"]) == set(result["weights"])
    assert (result["profile"], result["revision"]) == ("full", 3)
    assert client.get(f"{RECOGNITIONS}/{result['id']}").json() == result


def test_a_take_is_recognised_while_the_rest_of_its_clip_is_read(
    client: httpx.Client, studio: Studio, spoken: str
) -> None:
    recording = recording_of("circle")
    clip_id = add_recorded_clip(studio, recording, running=True)
    place, end = f"/api/v1/clips/{clip_id}", float(recording.poses.time[-1])
    assert_problem(client.get(f"{place}/takes"), 409, "clip_not_ready")
    (take,) = client.get(f"{place}/takes", params={"so_far": True}).json()
    asked = {"clip_id": clip_id, "language_id": spoken, "start": take["start"]}
    asked["expected"] = "circle"
    answer = client.post(RECOGNITIONS, json={**asked, "end": take["end"]}).json()
    assert answer["label"] == "circle"
    explanation = client.get(f"{RECOGNITIONS}/{answer['id']}/explanation")
    assert explanation.status_code == 200, explanation.text
    # The whole clip is not there yet, and neither is what comes after the frames so far.
    for later in ({}, {"end": end + 1.0}):
        assert_problem(client.post(RECOGNITIONS, json={**asked, **later}), 409, "clip_not_ready")
    saved = client.post(
        f"/api/v1/languages/{spoken}/gestures", json={"label": "loop", "clip_id": clip_id}
    )
    assert_problem(saved, 409, "clip_not_ready")


def test_a_take_between_two_gestures_is_kept_with_the_pair_and_older_records_have_none(
    client: httpx.Client, studio: Studio, circle_clip: str
) -> None:
    language = add_ambiguous_language(client).rpartition("/")[2]
    asked = {"clip_id": circle_clip, "language_id": language, "expected": "ring"}
    made = client.post(RECOGNITIONS, json=asked).json()
    assert made["label"] is None
    assert set(made["pair"]) == {"circle", "ring"}
    place = f"{RECOGNITIONS}/{made['id']}"
    assert client.get(place).json()["pair"] == made["pair"]
    explained = client.get(f"{place}/explanation").json()
    assert explained["pair"] == made["pair"]
    assert "are nearly alike" in explained["sentence"]
    record = studio.recognitions.get(made["id"])
    older = json.loads(record.result)
    del older["pair"]
    again = RecognitionRecord(
        **record.model_dump(exclude={"id", "result"}), result=json.dumps(older)
    )
    kept = studio.recognitions.add(again)
    assert client.get(f"{RECOGNITIONS}/{kept.id}").json()["pair"] is None


def test_a_recognition_outlives_what_its_language_becomes(
    client: httpx.Client, spoken: str, line_clip: str
) -> None:
    body = {"clip_id": line_clip, "language_id": spoken}
    result = client.post(RECOGNITIONS, json=body).json()
    client.delete(f"{LANGUAGES}/{spoken}/gestures/line")
    assert client.get(f"{RECOGNITIONS}/{result['id']}").json()["label"] == "line"
    assert client.post(RECOGNITIONS, json=body).json()["gestures"] == ["circle"]
    listed = client.get(RECOGNITIONS, params={"clip_id": line_clip}).json()
    assert [row["revision"] for row in listed] == [4, 3]


def test_what_cannot_be_recognised_says_why(
    client: httpx.Client, language_id: str, circle_clip: str, spoken: str
) -> None:
    empty = client.post(LANGUAGES, json={"name": "empty"}).json()["id"]
    body = {"clip_id": circle_clip, "language_id": empty}
    assert_problem(client.post(RECOGNITIONS, json=body), 422, "language_invalid")
    unknown = {"clip_id": circle_clip, "language_id": spoken, "profile": "psychic"}
    problem = assert_problem(client.post(RECOGNITIONS, json=unknown), 422, "recognition")
    assert "paper" in str(problem["detail"])
    for missing in ({"clip_id": "x", "language_id": spoken}, body | {"language_id": "x"}):
        assert_problem(client.post(RECOGNITIONS, json=missing), 404, "not_found")


def test_a_cut_of_a_demonstration_is_told_with_its_clip(
    studio: Studio, spoken: str, circle_clip: str
) -> None:
    language = language_of(studio.languages.get(spoken))
    values = {"label": "circle", "demonstration": 0, "start": 0.2, "end": 1.0}
    cut = Counterfactual(
        change=Intervention("demonstration_cut", 0.5, values),
        label="circle",
        confidence=1.0,
        margin=0.1,
        effect=None,
    )
    (found,) = locate_cuts(studio.demonstrations, language, [cut])
    told = found.change.to_dict()
    assert told["clip_id"] == circle_clip
    assert told["clip_end"] - told["clip_start"] == pytest.approx(0.8)
    assert found.change.words == cut.change.words
    later = Intervention("demonstration_cut", 0.5, {**values, "demonstration": 1})
    assert list(locate_cuts(studio.demonstrations, language, [replace(cut, change=later)])) == []


def test_a_recognition_is_explained_by_what_was_meant(
    client: httpx.Client, studio: Studio, spoken: str
) -> None:
    clip_id = add_recorded_clip(studio, recording_of("line"))
    body = {"clip_id": clip_id, "language_id": spoken, "expected": "circle"}
    kept = client.post(RECOGNITIONS, json=body).json()
    answer = client.get(f"{RECOGNITIONS}/{kept['id']}/explanation")
    assert answer.status_code == 200
    why = answer.json()
    assert (why["id"], why["expected"], why["label"]) == (kept["id"], "circle", "line")
    assert (why["right"], why["other"]) == (False, "line")
    assert {each["voter"] for each in why["breakdown"]} == set(kept["voters"])
    assert why["tried"] > 0
    assert all(each["effect"]["lost"] == [] for each in why["counterfactuals"] if each["effect"])
    assert (why["nearest"], why["runner_up"]) == ("line", "circle")
    assert why["sentence"] == "You showed: right (ends). 'circle': clockwise loop, down right."
    assert why["transcript"]["shown"][0]["words"] == "right"
    assert why["transcript"]["differs"] == 1
    assert [each["text"] for each in why["strokes"][0]] == ["You showed: ", "right", " (ends)"]
    assert len(why["sentence"].split()) <= 15
    assert any(line.startswith("Confidence") for line in why["details"])
    start, end = kept["start"], kept["end"]
    assert all(start <= moment <= end for moment in why["alignments"][0]["time"])
    as_it_was = client.get(
        f"{RECOGNITIONS}/{kept['id']}/explanation", params={"expected": "line"}
    ).json()
    assert as_it_was["right"]
    assert as_it_was["counterfactuals"] == []


def test_what_was_not_meant_to_be_anything_cannot_be_explained(
    client: httpx.Client, spoken: str, line_clip: str
) -> None:
    body = {"clip_id": line_clip, "language_id": spoken}
    url = f"{RECOGNITIONS}/{client.post(RECOGNITIONS, json=body).json()['id']}/explanation"
    assert_problem(client.get(url), 422, "expected_missing")
    problem = assert_problem(client.get(url, params={"expected": "spiral"}), 422, "recognition")
    assert "circle, line" in str(problem["detail"])
    assert_problem(client.get(f"{RECOGNITIONS}/x/explanation"), 404, "not_found")


def test_a_tuning_changes_this_recognition_alone_and_is_told_with_it(
    client: httpx.Client, spoken: str, line_clip: str
) -> None:
    body = {"clip_id": line_clip, "language_id": spoken, "expected": "circle"}
    plain = client.post(RECOGNITIONS, json=body).json()
    tuned = client.post(RECOGNITIONS, json=body | {"tuning": {"weights": {"velocity": 0.0}}}).json()
    assert plain["tuning"] is None
    assert tuned["tuning"]["weights"] == {"velocity": 0.0}
    assert tuned["weights"]["velocity"] == 0.0 < plain["weights"]["velocity"]
    why = client.get(f"{RECOGNITIONS}/{tuned['id']}/explanation").json()
    (velocity,) = [each for each in why["breakdown"] if each["voter"] == "velocity"]
    assert velocity["weight"] == 0.0
    unknown = client.post(RECOGNITIONS, json=body | {"tuning": {"weights": {"magic": 1.0}}})
    assert unknown.status_code == 422
    assert "no voter 'magic'" in unknown.json()["detail"]


def test_a_tuning_that_the_language_keeps_changes_every_recognition(
    client: httpx.Client, spoken: str, line_clip: str
) -> None:
    place, body = f"{LANGUAGES}/{spoken}", {"clip_id": line_clip, "language_id": spoken}
    before = client.post(RECOGNITIONS, json=body | {"expected": "circle"}).json()
    tuning = {"weights": {"hu": 0.0}, "simplification": 8.0}
    kept = client.patch(place, json={"profile": "paper", "tuning": tuning}).json()
    assert kept["profile"] == "paper"
    assert kept["tuning"] == tuning | {"keypoints_repaired": None}
    assert kept["change"] == (
        "Recognise by the profile paper, without the comparison hu and with drawings "
        "simplified by 8 pixels"
    )
    tuned = client.post(RECOGNITIONS, json=body).json()
    assert (tuned["profile"], tuned["weights"]["hu"], tuned["tuning"]) == ("paper", 0.0, None)
    # An earlier recognition is explained with the language as it was then.
    why = client.get(f"{RECOGNITIONS}/{before['id']}/explanation").json()
    assert why["profile"] == "full"
    silent = {"tuning": {"weights": dict.fromkeys(tuned["voters"], 0.0)}}
    assert client.patch(place, json=silent).status_code == 422
    again = client.patch(place, json={"profile": "full", "tuning": None}).json()
    assert (again["profile"], again["tuning"]) == ("full", None)
    assert again["tuning_words"] == "as the profile does"


def test_a_trial_recognises_with_a_changed_gesture_and_edits_nothing(
    client: httpx.Client, studio: Studio, spoken: str
) -> None:
    strict = client.patch(f"{LANGUAGES}/{spoken}/gestures/circle", json={"direction": "on"})
    revision = strict.json()["revision"]
    clip_id = add_recorded_clip(studio, recording_of("circle backwards"))
    body = {"clip_id": clip_id, "language_id": spoken, "expected": "circle"}
    assert client.post(RECOGNITIONS, json=body).json()["label"] is None
    trial = {"label": "circle", "change": {"direction": "off"}}
    tried = client.post(RECOGNITIONS, json=body | {"trial": trial}).json()
    assert (tried["label"], tried["revision"]) == ("circle", revision)
    assert tried["trial"]["change"]["direction"] == "off"
    # The explanation is about the trial, and the language has no new revision.
    why = client.get(f"{RECOGNITIONS}/{tried['id']}/explanation").json()
    assert why["right"]
    assert client.get(f"{LANGUAGES}/{spoken}").json()["revision"] == revision
    assert client.post(RECOGNITIONS, json=body).json()["label"] is None


def test_a_demonstration_on_trial_reads_other_takes_and_not_its_own(
    client: httpx.Client, studio: Studio, spoken: str
) -> None:
    own, other = (add_recorded_clip(studio, recording_of("square")) for _ in range(2))
    change = {"demonstration": {"clip_id": own}, "further": True}
    trial = {"trial": {"label": "line", "change": change}}
    body = {"language_id": spoken, "expected": "line"}
    before = client.post(RECOGNITIONS, json=body | {"clip_id": own}).json()
    tried = client.post(RECOGNITIONS, json=body | trial | {"clip_id": own}).json()
    assert tried["without"] == [["line", 1]]
    assert tried["label"] == before["label"] == "circle"
    assert tried["confidence"] == before["confidence"]
    why = client.get(f"{RECOGNITIONS}/{tried['id']}/explanation")
    assert not why.raise_for_status().json()["right"]
    read = client.post(RECOGNITIONS, json=body | trial | {"clip_id": other}).json()
    assert (read["label"], read["without"]) == ("line", [])


def test_a_demonstration_is_read_by_the_others_of_its_gesture(
    client: httpx.Client, studio: Studio, language_id: str, spoken: str, circle_clip: str
) -> None:
    body = {"clip_id": circle_clip, "language_id": spoken}
    assert client.post(RECOGNITIONS, json=body).json()["without"] == []  # the only one
    circle = recording_of("circle")
    shaken = circle.poses.xy + np.random.default_rng(1).normal(0, 0.5, circle.poses.xy.shape)
    other = add_recorded_clip(studio, replace(circle, poses=replace(circle.poses, xy=shaken)))
    shown = {"label": "circle", "clip_id": other}
    client.post(f"{LANGUAGES}/{language_id}/demonstrations", json=shown).raise_for_status()
    read = client.post(RECOGNITIONS, json=body).json()
    assert (read["label"], read["without"]) == ("circle", [["circle", 0]])
    assert client.get(f"{RECOGNITIONS}/{read['id']}/explanation?expected=line").status_code == 200


def test_a_trial_of_a_gesture_that_is_not_there_is_refused(
    client: httpx.Client, spoken: str, circle_clip: str
) -> None:
    trial = {"label": "square", "change": {"direction": "off"}}
    body = {"clip_id": circle_clip, "language_id": spoken, "trial": trial}
    assert_problem(client.post(RECOGNITIONS, json=body), 404, "not_found")


def test_a_bad_demonstration_is_named_as_the_reason(
    client: httpx.Client, studio: Studio, language_id: str, circle_clip: str
) -> None:
    gestures = f"/api/v1/languages/{language_id}/gestures"
    (take,) = client.get(f"/api/v1/clips/{circle_clip}/takes").json()
    half = take["stroke_start"] + 0.5 * (take["stroke_end"] - take["stroke_start"])
    cut = {"clip_id": circle_clip, "start": take["stroke_start"], "end": half}
    saved = client.post(gestures, json={"label": "circle", **cut}).json()
    assert saved["gestures"][0]["source"]["fault"].startswith("is cut short: it keeps 1.0 of")
    line = add_recorded_clip(studio, recording_of("line"), "line.mp4")
    client.post(gestures, json={"label": "line", "clip_id": line}).raise_for_status()
    report = client.get(f"/api/v1/languages/{language_id}/check").json()
    finding = report["warnings"][0]
    assert (finding["kind"], finding["gestures"]) == ("demonstration_fault", ["circle"])
    assert finding["message"] == "The demonstration of 'circle' is cut short. Set its range."
    assert report["ok"] is False
    other = add_recorded_clip(studio, recording_of("circle"), "other.mp4")
    body = {"clip_id": other, "language_id": language_id, "expected": "circle"}
    recognised = client.post("/api/v1/recognitions", json=body).json()
    why = client.get(f"/api/v1/recognitions/{recognised['id']}/explanation").json()
    assert why["sentence"] == "The demonstration of 'circle' is cut short. Set its range."
