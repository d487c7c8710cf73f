"""Weighted non-maximum suppression."""

from __future__ import annotations

from random import Random

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.region import (
    blend_overlapping,
    measure_overlaps,
    select_best,
)
from app.recognition.poses.sequence import FloatArray


@st.composite
def candidates(draw: st.DrawFn) -> tuple[FloatArray, FloatArray]:
    """Boxes with one keypoint each, ``(N, 3, 2)``, and scores ``(N,)``."""
    count = draw(st.integers(1, 8))
    number = st.floats(0, 100)
    corner = np.array(draw(st.lists(st.tuples(number, number), min_size=count, max_size=count)))
    side = st.floats(1, 60)
    extent = np.array(draw(st.lists(st.tuples(side, side), min_size=count, max_size=count)))
    scores = draw(st.lists(st.floats(0.5, 1), min_size=count, max_size=count, unique=True))
    points = np.stack([corner, corner + extent, corner + extent / 2], axis=1)
    return points, np.array(scores)


@given(candidates())
def test_results_overlap_no_better_one_they_could_have_joined(
    given_candidates: tuple[FloatArray, FloatArray],
) -> None:
    points, scores = given_candidates
    found = blend_overlapping(points, scores, 0.3)
    bests = [points[scores == detection.score][0, :2] for detection in found]
    for index, box in enumerate(bests):
        for better in bests[:index]:
            assert measure_overlaps(better, box[None])[0] <= 0.3


@given(candidates())
def test_the_best_are_those_that_opencv_keeps(
    given_candidates: tuple[FloatArray, FloatArray],
) -> None:
    boxes = given_candidates[0][:, :2]
    # OpenCV orders by scores in single precision.
    scores = given_candidates[1].astype(np.float32).astype(np.float64)
    extents = np.concatenate([boxes[:, 0], boxes[:, 1] - boxes[:, 0]], axis=1)
    kept = cv2.dnn.NMSBoxes(extents.tolist(), scores.tolist(), 0.25, 0.7)
    assert select_best(boxes, scores, 0.7).tolist() == list(kept)


def test_of_no_boxes_none_is_the_best() -> None:
    assert select_best(np.zeros((0, 2, 2)), np.zeros(0), 0.7).tolist() == []


@given(candidates())
def test_results_come_best_first_and_never_more_than_given(
    given_candidates: tuple[FloatArray, FloatArray],
) -> None:
    points, scores = given_candidates
    found = blend_overlapping(points, scores, 0.3)
    assert 1 <= len(found) <= len(points)
    assert found[0].score == scores.max()
    assert [one.score for one in found] == sorted((one.score for one in found), reverse=True)


@given(candidates(), st.randoms(use_true_random=False))
def test_order_of_the_candidates_does_not_matter(
    given_candidates: tuple[FloatArray, FloatArray], random: Random
) -> None:
    points, scores = given_candidates
    order = list(range(len(points)))
    random.shuffle(order)
    for one, other in zip(
        blend_overlapping(points, scores, 0.3),
        blend_overlapping(points[order], scores[order], 0.3),
        strict=True,
    ):
        np.testing.assert_allclose(one.box, other.box)
        assert one.score == other.score


def test_what_does_not_overlap_is_left_alone() -> None:
    points = np.array([[[0, 0], [10, 10], [5, 5]], [[50, 50], [60, 60], [55, 55]]], dtype=float)
    found = blend_overlapping(points, np.array([0.6, 0.9]), 0.3)
    np.testing.assert_array_equal(found[0].box, points[1, :2])
    np.testing.assert_array_equal(found[1].keypoints, points[0, 2:])


def test_one_object_is_the_score_weighted_mean_of_its_candidates() -> None:
    points = np.array([[[0, 0], [10, 10], [4, 4]], [[2, 0], [12, 10], [8, 4]]], dtype=float)
    (found,) = blend_overlapping(points, np.array([0.6, 0.9]), 0.3)
    assert found.box[0, 0] == pytest.approx(2 * 0.9 / 1.5)
    assert found.keypoints[0, 0] == pytest.approx((4 * 0.6 + 8 * 0.9) / 1.5)
    assert found.score == 0.9


def test_boxes_without_area_share_nothing_and_end() -> None:
    points = np.zeros((3, 3, 2))
    assert len(blend_overlapping(points, np.array([0.5, 0.6, 0.7]), 0.3)) == 3


def test_overlap_of_known_boxes() -> None:
    box = np.array([[0.0, 0.0], [2.0, 2.0]])
    others = np.array([box, box + 1, box + 2, [[0, 0], [1, 2]]])
    np.testing.assert_allclose(measure_overlaps(box, others), [1, 1 / 7, 0, 0.5])
