"""The table of takes over HTTP: all takes of clips, with the columns of the command line."""

from __future__ import annotations

import csv
import io

import httpx
import pytest

from app.evaluation.take_table import COLUMNS
from tests.api.languages import LANGUAGES
from tests.api.running import Running, assert_problem
from tests.browser.library import add_clip, library_of


def test_all_takes_of_clips_are_in_one_table(server: Running, client: httpx.Client) -> None:
    library = library_of(server, client, "dives")
    both = add_clip(server, "line", "circle", name="both.mp4")
    first = client.get(f"/api/v1/clips/{both}/takes").json()[0]
    labelled = {"clip_id": both, "start": first["start"], "end": first["end"], "expected": "line"}
    address = f"{LANGUAGES}/{library.language}"
    added = client.post(f"{address}/test-set", json={"takes": [labelled]})
    assert added.status_code == 201, added.text
    body = {"id": "mine", "clip_ids": [library.clip, both]}
    answer = client.post(f"{address}/take-table", json=body)
    assert answer.status_code == 200, answer.text
    table = answer.json()
    assert [(row["clip"], row["take"], row["label"]) for row in table["rows"]] == [
        ("dives.mp4", 1, "circle"),
        ("both.mp4", 1, "line"),
        ("both.mp4", 2, "circle"),
    ]
    assert [row["runner_up"] for row in table["rows"]] == ["line", "circle", "line"]
    assert [row["expected"] for row in table["rows"]] == [None, "line", None]
    assert table["rows"][1]["start"] == pytest.approx(first["start"], abs=1e-3)
    written = list(csv.DictReader(io.StringIO(table["csv"])))
    assert list(written[0]) == list(COLUMNS)
    assert [row["label"] for row in written] == ["circle", "line", "circle"]
    assert client.get(f"/api/v1/recognitions?clip_id={both}").json() == []


@pytest.mark.parametrize("trigger", ["salute", "none"])
def test_a_row_says_of_a_take_what_its_recognition_says(
    server: Running, client: httpx.Client, trigger: str
) -> None:
    library = library_of(server, client, f"by {trigger}")
    address = f"{LANGUAGES}/{library.language}"
    client.put(f"{address}/trigger", json={"kind": trigger}).raise_for_status()
    clip = add_clip(server, "line", "circle", name="both.mp4")
    takes = client.get(f"/api/v1/clips/{clip}/takes?language_id={library.language}").json()
    assert takes
    body = {"id": f"by {trigger}", "clip_ids": [clip]}
    rows = client.post(f"{address}/take-table", json=body).json()["rows"]
    told = ("nearest", "confidence")
    for row, take in zip(rows, takes, strict=True):
        wanted = {"start": take["start"], "end": take["end"]}
        body = {"clip_id": clip, "language_id": library.language} | wanted
        recognition = client.post("/api/v1/recognitions", json=body).json()
        assert [row[name] for name in told] == pytest.approx(
            [recognition[name] for name in told], abs=1e-3
        )


def test_a_table_of_an_absent_clip_is_refused(server: Running, client: httpx.Client) -> None:
    library = library_of(server, client, "lone")
    body = {"id": "mine", "clip_ids": ["absent"]}
    address = f"{LANGUAGES}/{library.language}/take-table"
    assert_problem(client.post(address, json=body), 404, "not_found")
