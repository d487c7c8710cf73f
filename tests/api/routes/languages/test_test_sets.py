"""Test sets over HTTP: labelled takes, their results after every change, and their rates."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest

from app.api.services.running_studio import Studio
from app.api.services.test_sets import test_run_key as key_of_run
from app.recognition import Gesture, Language, Recording, takes_in
from app.store import JobStatus
from tests.api.languages import LANGUAGES, add_ambiguous_language, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem, until
from tests.api.running_workers import linux, workers_of

pytestmark = pytest.mark.slow


@pytest.fixture
def place(client: httpx.Client, language_id: str, circle_clip: str, line_clip: str) -> str:
    """Return the address of the test set of a language with a circle and a line."""
    add_gesture(client, language_id, circle_clip, "circle")
    add_gesture(client, language_id, line_clip, "line")
    return f"{LANGUAGES}/{language_id}/test-set"


def labelled(client: httpx.Client, place: str, *takes: dict[str, Any]) -> httpx.Response:
    return client.post(place, json={"takes": list(takes)})


def run(client: httpx.Client, place: str) -> Any:
    answer = client.post(f"{place}/run")
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_takes_are_recognised_and_the_only_demonstration_of_a_gesture_cannot_be_tested(
    client: httpx.Client, studio: Studio, place: str, circle_clip: str
) -> None:
    other = add_recorded_clip(studio, recording_of("circle", "line"), "two.mp4")
    added = labelled(
        client,
        place,
        {"clip_id": other, "expected": "circle"},
        {"clip_id": circle_clip, "expected": "circle"},
    )
    assert added.status_code == 201
    assert added.json()["waiting"] == 2
    assert added.json()["overall"]["rate"] is None
    found = run(client, place)
    assert found["waiting"] == 0
    kinds = [
        (take["clip"], take["testable"], take["result"] and take["result"]["right"])
        for take in found["takes"]
    ]
    assert kinds == [("dive.mp4", False, None), ("two.mp4", True, True), ("two.mp4", True, False)]
    counts = {"right": 1, "asked": 2, "untestable": 1}
    assert counts.items() <= found["overall"].items()
    assert 0 < found["overall"]["low"] < 0.5 < found["overall"]["high"] < 1
    (rate,) = found["gestures"]
    assert (rate["label"], rate["right"], rate["asked"]) == ("circle", 1, 2)
    recognition = found["takes"][2]["result"]["recognition_id"]
    kept = client.get(f"/api/v1/recognitions/{recognition}").json()
    assert (kept["label"], kept["expected"]) == ("line", "circle")


def test_a_take_that_shows_none_of_the_gestures_is_right_if_it_is_refused(
    client: httpx.Client, studio: Studio, place: str
) -> None:
    drawn = {shape: add_recorded_clip(studio, recording_of(shape)) for shape in ("corner", "line")}
    takes = [{"clip_id": clip, "expected_none": True} for clip in drawn.values()]
    assert labelled(client, place, *takes).status_code == 201
    found = run(client, place)
    assert [(take["expected"], take["expected_none"]) for take in found["takes"]] == [
        (None, True),
        (None, True),
    ]
    by_clip = {take["clip_id"]: take["result"] for take in found["takes"]}
    assert by_clip[drawn["line"]]["label"] == "line"
    refused = by_clip[drawn["corner"]]
    assert (refused["label"], refused["right"]) == (None, refused["pair"] is None)
    assert found["none"]["answered"] == 1
    assert found["none"]["refused"] + found["none"]["asked_back"] == 1
    assert found["overall"]["right"] == found["none"]["refused"]
    assert (found["overall"]["asked"], found["gestures"]) == (2, [])
    kept = client.get(f"/api/v1/recognitions/{refused['recognition_id']}").json()
    assert (kept["expected"], kept["expected_none"]) == (None, True)

    take = next(each for each in found["takes"] if each["clip_id"] == drawn["line"])
    known = client.patch(f"{place}/{take['id']}", json={"expected": "line"}).json()
    assert known["takes"][0 if known["takes"][0]["id"] == take["id"] else 1]["expected"] == "line"
    for unclear in ({}, {"expected": "line", "expected_none": True}, {"expected_none": "yes"}):
        assert_problem(client.patch(f"{place}/{take['id']}", json=unclear), 422, "request_invalid")


def test_a_take_of_a_gesture_that_the_language_lacks_cannot_be_tested(
    client: httpx.Client, studio: Studio, place: str
) -> None:
    clip = add_recorded_clip(studio, recording_of("corner"))
    found = labelled(client, place, {"clip_id": clip, "expected": "triangle"}).json()
    assert (found["waiting"], found["overall"]["untestable"]) == (0, 1)


def test_a_take_that_becomes_a_demonstration_stays_and_is_read_without_it(
    client: httpx.Client, studio: Studio, language_id: str, place: str
) -> None:
    line = recording_of("line")
    shaken = line.poses.xy + np.random.default_rng(1).normal(0, 0.5, line.poses.xy.shape)
    other = Recording(replace(line.poses, xy=shaken), line.hands, line.salute)
    wrong = add_recorded_clip(studio, other, "wrong.mp4")
    right = add_recorded_clip(studio, recording_of("circle"), "right.mp4")
    takes = [{"clip_id": clip, "expected": "circle"} for clip in (wrong, right)]
    labelled(client, place, *takes)
    before = run(client, place)
    assert {"right": 1, "asked": 2, "untestable": 0}.items() <= before["overall"].items()
    added = client.post(
        f"{LANGUAGES}/{language_id}/demonstrations", json={"label": "circle", "clip_id": wrong}
    )
    assert added.status_code == 201, added.text
    after = run(client, place)
    assert {"right": 1, "asked": 2, "untestable": 0}.items() <= after["overall"].items()
    swallowed = next(take for take in after["takes"] if take["clip_id"] == wrong)
    assert swallowed["demonstration"]
    assert not swallowed["result"]["right"]
    kept = f"/api/v1/recognitions/{swallowed['result']['recognition_id']}"
    assert client.get(kept).json()["without"] == [["circle", 1]]
    # The explanation is of the same language: the take is not its own evidence.
    assert client.get(f"{kept}/explanation").json()["nearest"] == "line"
    assert (after["better"], after["worse"]) == ([], [])


def test_a_change_of_the_language_says_what_got_better_and_worse(
    client: httpx.Client, studio: Studio, language_id: str, place: str
) -> None:
    backwards = add_recorded_clip(studio, recording_of("circle backwards"), "backwards.mp4")
    labelled(client, place, {"clip_id": backwards, "expected": "circle"})
    gestures = f"{LANGUAGES}/{language_id}/gestures"

    def count_direction(position: str) -> None:
        changed = client.patch(gestures, params={"label": "circle"}, json={"direction": position})
        assert changed.status_code == 200

    count_direction("off")
    assert run(client, place)["overall"]["right"] == 1
    count_direction("on")
    assert client.get(place).json()["waiting"] == 1
    stricter = run(client, place)
    (take,) = stricter["takes"]
    assert (stricter["better"], stricter["worse"]) == ([], [take["id"]])
    assert (take["before"]["right"], take["result"]["right"]) == (True, False)
    count_direction("off")
    relaxed = run(client, place)
    assert (relaxed["better"], relaxed["worse"]) == ([take["id"]], [])


def test_the_first_run_after_an_upgrade_says_so(
    client: httpx.Client,
    studio: Studio,
    language_id: str,
    place: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clip = add_recorded_clip(studio, recording_of("circle"), "again.mp4")
    labelled(client, place, {"clip_id": clip, "expected": "circle"})
    upgraded = []
    for name, version in (
        ("one", "0.2.0"),
        ("two", "0.2.0"),
        ("three", "0.3.0"),
        ("four", "0.3.0"),
    ):
        monkeypatch.setattr("app.api.services.test_sets.__version__", version)
        client.patch(f"{LANGUAGES}/{language_id}", json={"name": name}).raise_for_status()
        upgraded.append(run(client, place)["upgraded"])
    assert upgraded == [False, False, True, False]


def test_a_pair_is_counted_on_its_own_and_lies_between_right_and_wrong(
    client: httpx.Client, studio: Studio
) -> None:
    language = add_ambiguous_language(client)
    place = f"{language}/test-set"
    clip = add_recorded_clip(studio, recording_of("circle", "line"), "two.mp4")
    labelled(client, place, {"clip_id": clip, "expected": "circle"})
    found = run(client, place)
    pair, wrong = (take["result"] for take in found["takes"])
    assert (pair["label"], pair["right"], set(pair["pair"])) == (None, False, {"circle", "ring"})
    assert (wrong["label"], wrong["pair"]) == ("line", None)
    counts = {name: found["overall"][name] for name in ("right", "asked", "pairs", "pairs_right")}
    assert counts == {"right": 0, "asked": 2, "pairs": 1, "pairs_right": 1}
    client.delete(f"{language}/gestures", params={"label": "ring"}).raise_for_status()
    better = run(client, place)
    assert (better["better"], better["worse"]) == ([found["takes"][0]["id"]], [])
    assert (better["overall"]["right"], better["overall"]["pairs"]) == (1, 0)


def test_a_label_within_a_pair_s_label_is_not_one_of_the_pair(
    client: httpx.Client, studio: Studio
) -> None:
    language = add_ambiguous_language(client)
    rename = {"label": "ri"}
    client.patch(f"{language}/gestures", params={"label": "line"}, json=rename).raise_for_status()
    clip = add_recorded_clip(studio, recording_of("circle"), "one.mp4")
    labelled(client, f"{language}/test-set", {"clip_id": clip, "expected": "ri"})
    found = run(client, f"{language}/test-set")["overall"]
    assert (found["pairs"], found["pairs_right"]) == (1, 0)


@pytest.mark.parametrize("stored", ["\u00e9", "e\u0301"])
def test_a_label_is_found_in_either_form_of_its_accents(
    client: httpx.Client, studio: Studio, stored: str
) -> None:
    shown = takes_in(recording_of("circle"))[0].poses
    gesture = replace(Gesture.from_demonstration("circle", shown), label=stored)
    content = Language("accents", [gesture]).to_json()
    language = client.post(f"{LANGUAGES}/import", content=content).json()["id"]
    place = f"{LANGUAGES}/{language}/test-set"
    clip = add_recorded_clip(studio, recording_of("circle"), "again.mp4")
    for typed in ("\u00e9", "e\u0301"):
        (take,) = labelled(client, place, {"clip_id": clip, "expected": typed}).json()["takes"]
        assert run(client, place)["overall"]["right"] == 1
        client.delete(f"{place}/{take['id']}").raise_for_status()
        asked = {"clip_id": clip, "diver": "Ana", "expected": typed}
        answer = client.post(f"{LANGUAGES}/{language}/practice", json=asked).json()
        assert answer["take"]["right"]


def test_a_take_gets_another_label_and_is_removed(
    client: httpx.Client, studio: Studio, place: str
) -> None:
    clip = add_recorded_clip(studio, recording_of("circle"), "own.mp4")
    (take,) = labelled(client, place, {"clip_id": clip, "expected": "line"}).json()["takes"]
    assert run(client, place)["overall"]["right"] == 0
    changed = client.patch(f"{place}/{take['id']}", json={"expected": "circle"}).json()
    assert changed["waiting"] == 1
    assert run(client, place)["overall"]["right"] == 1
    assert client.delete(f"{place}/{take['id']}").json()["takes"] == []
    assert_problem(client.delete(f"{place}/{take['id']}"), 404, "not_found")
    assert_problem(client.patch(f"{place}/none", json={"expected": "a"}), 404, "not_found")


def test_a_take_that_cannot_be_recognised_says_why(
    client: httpx.Client, studio: Studio, place: str
) -> None:
    still = add_recorded_clip(studio, recording_of(), "still.mp4")
    labelled(client, place, {"clip_id": still, "expected": "circle"})
    found = run(client, place)
    (take,) = found["takes"]
    assert take["result"]["fault"]
    assert take["result"]["recognition_id"] is None
    assert (found["overall"]["right"], found["overall"]["asked"], found["waiting"]) == (0, 1, 0)


def test_a_run_without_takes_or_of_nothing_new_does_nothing(
    client: httpx.Client, place: str
) -> None:
    assert run(client, place)["takes"] == []
    assert client.delete(f"{place}/run").status_code == 204
    assert_problem(client.post(f"{LANGUAGES}/none/test-set/run"), 404, "not_found")


@linux
def test_a_run_is_a_process_that_is_cancelled_and_keeps_what_is_done(
    client: httpx.Client, studio: Studio, language_id: str, place: str
) -> None:
    clip = add_recorded_clip(studio, recording_of(*["circle"] * 20), "many.mp4")
    labelled(client, place, {"clip_id": clip, "expected": "circle"})
    key = key_of_run(language_id, client.get(place).json()["revision"])

    def has_begun() -> bool:
        progress = studio.runner.progress(key)
        return progress is not None and progress.done > 0

    with ThreadPoolExecutor(1) as asking:
        answer = asking.submit(client.post, f"{place}/run")
        until(lambda: workers_of(os.getpid(), "test"))
        until(has_begun)
        assert client.delete(f"{place}/run").status_code == 204
        assert_problem(answer.result(), 409, "test_run_cancelled")
    until(lambda: not workers_of(os.getpid(), "test"))
    assert 0 < client.get(place).json()["waiting"] < 20
    found = run(client, place)
    assert (found["waiting"], found["overall"]["asked"]) == (0, 20)


def test_a_run_goes_on_when_the_client_leaves(
    client: httpx.Client, studio: Studio, language_id: str, place: str
) -> None:
    clip = add_recorded_clip(studio, recording_of(*["circle"] * 20), "many.mp4")
    labelled(client, place, {"clip_id": clip, "expected": "circle"})
    key = key_of_run(language_id, client.get(place).json()["revision"])
    with (
        httpx.Client(base_url=client.base_url, timeout=0.3) as leaving,
        suppress(httpx.ReadTimeout),
    ):
        leaving.post(f"{place}/run")
    until(lambda: client.get(place).json()["waiting"] == 0)
    # The results are stored before the job ends.
    until(lambda: studio.runner.progress(key) is None)


@linux
def test_a_run_whose_process_dies_says_so_and_goes_on_when_asked_again(
    client: httpx.Client, studio: Studio, place: str
) -> None:
    clip = add_recorded_clip(studio, recording_of(*["circle"] * 40), "many.mp4")
    labelled(client, place, {"clip_id": clip, "expected": "circle"})
    with ThreadPoolExecutor(1) as asking:
        answer = asking.submit(client.post, f"{place}/run")
        until(lambda: workers_of(os.getpid(), "test"))
        for worker in workers_of(os.getpid(), "test"):
            os.kill(worker, signal.SIGKILL)
        assert_problem(answer.result(), 422, "test_run_broken_off")
    assert run(client, place)["waiting"] == 0


def test_a_clip_whose_poses_are_gone_is_the_fault_of_its_takes_alone(
    client: httpx.Client, studio: Studio, place: str
) -> None:
    lost, whole = (
        add_recorded_clip(studio, recording_of("circle"), name) for name in ("a.mp4", "b.mp4")
    )
    for clip in (lost, whole):
        labelled(client, place, {"clip_id": clip, "expected": "circle"})
    with studio.jobs._database.writing() as session:
        job = studio.clips.get(lost).job
        job.status = JobStatus.FAILED.value
        session.merge(job)
    found = run(client, place)
    assert "not extracted" in found["takes"][0]["result"]["fault"]
    assert found["takes"][1]["result"]["right"]
