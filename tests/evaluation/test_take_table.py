"""Rows of the table of takes, as page and command line show them."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from typing import Literal

import pytest

from app.evaluation.take_table import COLUMNS, NO_TAKE, row_of_fault, rows_of_clip, write_csv
from app.recognition import Recognizer, takes_in
from app.recognition.triggers.trigger import Trigger
from tests.api.recordings import recording_of
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    return Recognizer(pool(circle=circle, line=line))


def test_a_take_is_a_row_with_its_runner_up_and_what_was_expected(recognizer: Recognizer) -> None:
    recording = recording_of("circle", "line")
    results = [(take, recognizer.recognize(take.poses)) for take in takes_in(recording)]
    rows = rows_of_clip("dive.mp4", recognizer, recording, results, {2: "line"})
    assert all(set(row) == set(COLUMNS) for row in rows)
    assert [(row["nearest"], row["runner_up"]) for row in rows] == [
        ("circle", "line"),
        ("line", "circle"),
    ]
    assert [row["expected"] for row in rows] == [None, "line"]


def test_a_take_between_two_gestures_has_no_label_but_a_pair() -> None:
    recording = recording_of("circle", "line")
    asking = Recognizer(pool(circle=circle, ring=circle, line=line))
    results = [(take, asking.recognize(take.poses)) for take in takes_in(recording)]
    first, second = rows_of_clip("dive.mp4", asking, recording, results)
    assert (first["label"], first["pair"]) == (None, "circle or ring")
    assert (second["label"], second["pair"]) == ("line", None)


@pytest.mark.parametrize("kind", ["salute", "none"])
def test_warnings_of_salutes_reach_languages_with_salutes_alone(
    recognizer: Recognizer, kind: Literal["salute", "none"]
) -> None:
    recording = replace(recording_of("circle"), warnings=("dark",), salute_warnings=("few hands",))
    spoken = Recognizer(replace(recognizer.language, trigger=Trigger(kind)))
    (row,) = rows_of_clip("dive.mp4", spoken, recording, [])
    told = "dark; few hands" if kind == "salute" else "dark"
    assert row["faults"] == f"{told}; {NO_TAKE}"


def test_a_language_of_one_gesture_has_no_runner_up() -> None:
    recording, lone = recording_of("circle"), Recognizer(pool(circle=circle))
    results = [(take, lone.recognize(take.poses)) for take in takes_in(recording)]
    assert rows_of_clip("dive.mp4", lone, recording, results)[0]["runner_up"] is None


def test_a_clip_without_takes_is_a_row_with_its_fault(recognizer: Recognizer) -> None:
    (row,) = rows_of_clip("=dive.mp4", recognizer, recording_of("circle"), [])
    assert row["take"] is None
    assert row["faults"].endswith(NO_TAKE)
    fault = row_of_fault("b.mp4", recognizer, "damaged", "dark")
    written = list(csv.DictReader(io.StringIO(write_csv([row, fault]))))
    assert [each["clip"] for each in written] == ["'=dive.mp4", "b.mp4"]
    assert written[1]["faults"] == "damaged; dark"
