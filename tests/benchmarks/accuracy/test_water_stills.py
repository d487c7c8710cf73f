"""Water stills: what counts as found, and which row a photograph belongs to."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import cv2
import numpy as np
import pytest

from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.water import WaterSight
from app.recognition.poses.frame import Body, FrameLandmarks, Hand
from benchmarks.accuracy.water_stills import (
    Score,
    Still,
    measure,
    read_stills,
    score_still,
    size_of,
)

DIVER = np.array([[[10.0, 10.0], [50.0, 90.0]]])
HANDS = np.array([[[10.0, 10.0], [20.0, 20.0]], [[40.0, 40.0], [50.0, 50.0]]])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder of four grey photographs from two waters."""
    (tmp_path / "images").mkdir()
    rows = ["image,what,x0,y0,x1,y1"]
    for name in ("lake_1.jpg", "lake_2.jpg", "sea-1.jpg", "sea-2.jpg"):
        cv2.imwrite(str(tmp_path / "images" / name), np.full((120, 160, 3), 90, np.uint8))
        rows += [f"{name},Diver,10,10,50,90", f"{name},Hand,10,10,20,20"]
    (tmp_path / "boxes.csv").write_text("\n".join(rows) + "\n")
    return tmp_path


def body_at(x: float, y: float) -> Body:
    return Body(np.full((33, 2), (x, y)), np.ones(33), 1.0)


def hand_at(x: float, y: float) -> Hand:
    return Hand(np.full((21, 2), (x, y)), "left", 1.0)


def test_what_lies_in_its_box_is_found() -> None:
    boxes = {"Diver": DIVER, "Head": DIVER / 2, "Hand": HANDS}
    found = FrameLandmarks(body_at(30, 60), (hand_at(15, 15), hand_at(80, 80)))
    score = score_still(boxes, found)
    assert (score.body.correct, score.body.asked) == (1, 1)
    assert (score.head.correct, score.head.asked) == (0, 1)
    assert (score.hand.correct, score.hand.asked) == (1, 2)
    assert (score.off.correct, score.off.asked) == (1, 2)


def test_a_hand_without_fingers_has_a_place_only() -> None:
    xy = np.full((21, 2), np.nan)
    xy[[0, 5, 9]] = (44, 42), (46, 48), (46, 48)
    found = FrameLandmarks(None, (hand_at(80, 80),), places=(Hand(xy, "left", 0.8),))
    score = score_still({"Hand": HANDS}, found)
    assert (score.hand.correct, score.place.correct, score.place.asked) == (0, 1, 2)
    assert (score.wrong.correct, score.wrong.asked) == (1, 2)


def test_a_wrist_is_right_near_its_hand_in_body_sizes() -> None:
    xy = np.full((33, 2), 15.0)
    xy[[11, 12, 23, 24]] = (10, 0), (20, 0), (10, 100), (20, 100)
    body = Body(xy, np.ones(33), 1.0)
    boxes = {"Hand": np.array([[[10.0, 35.0], [20.0, 45.0]], [[10.0, 60.0], [20.0, 70.0]]])}
    score = score_still(boxes, FrameLandmarks(body, ()))
    assert (score.wrist.correct, score.wrist.asked) == (1, 2)


def test_what_nobody_drew_a_box_around_is_not_asked_for() -> None:
    assert score_still({}, FrameLandmarks(body_at(1, 1), ())) == Score()
    missed = score_still({"Diver": DIVER}, FrameLandmarks(None, ()))
    assert (missed.body.correct, missed.body.asked) == (0, 1)


def test_photographs_are_read_by_water_and_part(folder: Path) -> None:
    stills = read_stills(folder)
    assert [still.water for still in stills] == ["lake", "lake", "sea", "sea"]
    even, odd = read_stills(folder, "even"), read_stills(folder, "odd")
    assert [still.path.name for still in even] == ["lake_1.jpg", "sea-1.jpg"]
    assert {still.path for still in (*even, *odd)} == {still.path for still in stills}


def test_rows_by_size_take_the_tallest_diver() -> None:
    image = np.zeros((100, 100, 3), np.uint8)
    assert size_of(Still(Path("a.jpg"), {"Diver": DIVER}), image) == (
        "diver 75% to 100% of the height"
    )
    assert size_of(Still(Path("a.jpg"), {}), image) == "no diver's box"


def test_nothing_is_found_in_plain_water(folder: Path, installed_models: None) -> None:
    with closing(create_estimator(threads=1)) as estimator:
        rows = list(measure(read_stills(folder), WaterSight(estimator, "off")))
    assert [row for row, _ in rows] == ["lake", "lake", "sea", "sea"]
    total = sum((score for _, score in rows), Score())
    assert (total.body.correct, total.body.asked) == (0, 4)
    assert (total.hand.correct, total.off.asked) == (0, 0)
