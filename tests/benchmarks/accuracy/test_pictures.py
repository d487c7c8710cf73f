"""Pictures: what counts as found, in which groups, and what is plain water."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from app.evaluation.share import Share
from app.recognition.poses.frame import Body, FrameLandmarks, Hand
from benchmarks.accuracy.pictures import (
    ALL,
    Still,
    crop_water,
    measure,
    measure_synthetic,
    read_stills,
    score_still,
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
    assert score["body"] == Share(1, 1)
    assert score["head"] == Share(0, 1)
    assert score["hand"] == Share(1, 2)
    assert score["stray"] == Share(1, 2)


def test_a_hand_without_fingers_has_a_place_only() -> None:
    xy = np.full((21, 2), np.nan)
    xy[[0, 5, 9]] = (44, 42), (46, 48), (46, 48)
    found = FrameLandmarks(None, (hand_at(80, 80),), places=(Hand(xy, "left", 0.8),))
    score = score_still({"Hand": HANDS}, found)
    assert score["hand"] == Share(0, 2)
    assert score["place"] == Share(1, 2)
    assert score["wrong"] == Share(1, 2)


def test_a_wrist_is_right_near_its_hand_in_body_sizes() -> None:
    xy = np.full((33, 2), 15.0)
    xy[[11, 12, 23, 24]] = (10, 0), (20, 0), (10, 100), (20, 100)
    body = Body(xy, np.ones(33), 1.0)
    boxes = {"Hand": np.array([[[10.0, 35.0], [20.0, 45.0]], [[10.0, 60.0], [20.0, 70.0]]])}
    score = score_still(boxes, FrameLandmarks(body, ()))
    assert score["wrist"] == Share(1, 2)


def test_a_wrist_within_a_hand_that_is_larger_than_the_body_is_right() -> None:
    xy = np.full((33, 2), 15.0)
    xy[[11, 12, 23, 24]] = (10, 0), (20, 0), (10, 30), (20, 30)
    body = Body(xy, np.ones(33), 1.0)
    near, nearer = ((0.0, 0.0), (60.0, 60.0)), ((10.0, 18.0), (20.0, 60.0))
    score = score_still({"Hand": np.array([near, nearer])}, FrameLandmarks(body, ()))
    assert score["wrist"] == Share(1, 2)


def test_what_nobody_drew_a_box_around_is_not_asked_for() -> None:
    score = score_still({}, FrameLandmarks(body_at(1, 1), ()))
    assert all(each.asked == 0 for each in score.values())
    assert score_still({"Diver": DIVER}, FrameLandmarks(None, ()))["body"] == Share(0, 1)


def test_a_photograph_is_counted_by_water_size_and_whether_it_chose_anything(folder: Path) -> None:
    first, second, third, fourth = read_stills(folder)
    assert [each.water for each in (first, fourth)] == ["lake", "sea"]
    assert [*first.groups(100)] == ["all", "lake", "near"]
    assert [*third.groups(200)] == ["all", "sea", "held", "held/sea", "far"]
    assert [*Still(Path("a.jpg"), {}).groups(100)] == ["all", "a"]
    assert second.boxes.keys() == {"Diver", "Hand"}


def test_plain_water_is_the_wider_side_beside_all_boxes() -> None:
    image = np.arange(160, dtype=np.uint8)[None, :, None] * np.ones((120, 1, 3), np.uint8)
    water = crop_water(Still(Path("a.jpg"), {"Diver": DIVER, "Hand": HANDS}), image)
    assert water is not None
    assert (water[0, 0, 0], water.shape) == (50, (120, 110, 3))
    wide = {"Diver": np.array([[[40.0, 0.0], [120.0, 90.0]]])}
    assert crop_water(Still(Path("a.jpg"), wide), image) is None
    assert crop_water(Still(Path("a.jpg"), {"Hand": HANDS}), image) is None


@pytest.mark.parametrize("taught", [True, False])
def test_nothing_is_found_in_plain_water(
    folder: Path, installed_models: None, taught: bool
) -> None:
    found = {each.name: each for each in measure(folder, "off", ALL, taught, quick=False)}
    assert (found["all/body"].value, found["all/body"].n) == (0, 4)
    assert (found["lake/hand"].value, found["lake/hand"].n) == (0, 2)
    assert (found["all/wrong"].value, found["all/stray"].n) == (0, 0)


def test_our_test_of_a_salute_sees_more_and_mistakes_fewer_than_the_published_rule() -> None:
    rates = {each.name: each.value for each in measure_synthetic(quick=True)}
    assert rates["ours/seen"] >= rates["published/seen"]
    assert rates["ours/false"] <= rates["published/false"] / 10
