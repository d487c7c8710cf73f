"""Rejection: what is no gesture of the language gets no label."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Gesture, Language, Recognizer
from app.recognition.decision.calibration import CUES
from app.recognition.decision.rejection import (
    CUE_GROUPS,
    MOST_CLEAR,
    build_novelty_weights,
    gather_thresholds,
    is_rejected,
    measure_clearness,
    measure_novelty,
)
from app.recognition.gestures.tuning import Tuning
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.registry import VOTER_NAMES
from tests.recognition.strategies import SHAPES, circle, line, recording

TAUGHT = ("circle", "wedge", "infinity", "square")


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    gestures = [Gesture.from_demonstration(name, recording(SHAPES[name])) for name in TAUGHT]
    return Recognizer(Language("pool", gestures))


def zigzag(share: FloatArray) -> FloatArray:
    height = 0.4 * np.abs((6 * share) % 2 - 1)
    return np.stack([-1.2 + share, height], axis=1)


def test_a_foreign_movement_has_no_label_but_a_nearest_gesture(recognizer: Recognizer) -> None:
    result = recognizer.recognize(recording(zigzag, jitter=0.01))
    assert result.label is None
    nearest = result.gestures.index(result.nearest)
    assert result.scores[nearest] == result.scores.min()
    assert result.novelty[nearest] > 1
    assert result.confidence < 0.5 < recognizer.recognize(recording(circle)).confidence


@pytest.mark.parametrize("name", TAUGHT)
def test_another_take_is_far_from_being_rejected(recognizer: Recognizer, name: str) -> None:
    poses = recording(SHAPES[name], frames=95, rate=25, torso=60, centre=(200, 300), jitter=0.01)
    result = recognizer.recognize(poses)
    assert result.label == name
    assert result.novelty[result.gestures.index(name)] < 0.5


def test_profile_paper_never_rejects(recognizer: Recognizer) -> None:
    result = Recognizer(recognizer.language, "paper").recognize(recording(zigzag))
    assert result.label == result.nearest
    assert np.isnan(result.novelty).all()


def test_novelty_is_the_largest_of_what_each_view_tells(recognizer: Recognizer) -> None:
    result = recognizer.recognize(recording(zigzag, jitter=0.01))
    assert result.novelty_by_view.keys() == CUE_GROUPS.keys()
    each = [*result.novelty_by_view.values()]
    np.testing.assert_array_equal(result.novelty, np.fmax.reduce(each))


def test_a_view_whose_voters_are_off_tells_nothing(recognizer: Recognizer) -> None:
    off = Tuning(weights=dict.fromkeys(CUE_GROUPS["place"], 0.0))
    query = recording(circle, frames=95, jitter=0.01)
    before = recognizer.recognize(query).novelty_by_view
    after = Recognizer(recognizer.language, tuning=off).recognize(query).novelty_by_view
    assert np.isfinite(before["place"]).all()
    assert np.isnan(after["place"]).all()
    np.testing.assert_array_equal(after["movement"], before["movement"])


def test_novelty_is_the_largest_of_the_views_weighted_means_of_distances_over_thresholds() -> None:
    distances = np.array([[2.0, 1.0, 1.0, 0.5], [9.0, 4.0, np.inf, 2.0], [4.0, np.inf, 1.0, 0.2]])
    thresholds = np.array([[1.0, 2.0, np.inf, 1.0], [np.inf, 2.0, 1.0, 2.0], [4.0, 1.0, np.inf, 1]])
    views = np.array([[1.0, 3.0, 0.0], [0.0, 0.0, 2.0]])
    measured = measure_novelty(distances, thresholds, views)
    np.testing.assert_allclose(measured, [2.0, (0.5 + 3 * 2) / 4, np.nan, (0.5 + 3 * 1) / 4])
    assert [is_rejected(each) for each in measured] == [True, True, False, False]


def test_what_is_held_alike_does_not_make_up_for_what_is_drawn_otherwise() -> None:
    """A voter of another cue group without a difference does not change the novelty."""
    views = build_novelty_weights(VOTER_NAMES)
    distances = np.where(views[0] > 0, 2.0, np.inf)[:, None]
    calm = np.where(np.isfinite(distances), distances, 0.0)
    ones = np.ones((len(VOTER_NAMES), 1))
    assert measure_novelty(calm, ones, views) == measure_novelty(distances, ones, views) == 2.0


def test_a_voter_of_a_view_has_a_threshold_in_every_gesture(recognizer: Recognizer) -> None:
    thresholds = gather_thresholds(recognizer.language.gestures, VOTER_NAMES)
    asked = (build_novelty_weights(VOTER_NAMES) > 0).any(axis=0)
    assert np.isfinite(thresholds[asked]).all()
    assert not np.isfinite(thresholds[~asked]).any()
    assert {voter for view in CUE_GROUPS.values() for voter in view} == set(CUES)


def test_an_imported_gesture_is_not_rejected() -> None:
    drawn = Gesture.from_demonstration("circle", recording(circle))
    imported = Gesture(label="circle", salient=drawn.salient, image=drawn.image)
    result = Recognizer(Language("one", [imported])).recognize(recording(line))
    assert result.label == "circle"
    assert np.isnan(result.novelty).all()
    assert 0.0 <= result.confidence <= 1.0


def test_thresholds_widen_for_a_gesture_that_is_much_nearer_than_any_other() -> None:
    clear, usual, close = (
        measure_clearness(np.array([0.3, other, 2.0])) for other in (1.2, 0.3 / 0.6, 0.31)
    )
    assert MOST_CLEAR <= clear[0] < usual[0] < 1.1 < close[0]
    assert usual[0] == pytest.approx(1.0, rel=0.1)
    # Of the others none is the nearest: they are never clear.
    assert (np.stack([clear, usual, close])[:, 1:] > 1).all()


@given(st.lists(st.floats(0, 50), min_size=2, max_size=6), st.floats(0.5, 3))
def test_clearness_is_bounded_and_depends_on_each_score_alone(
    scores: list[float], worse: float
) -> None:
    found = measure_clearness(np.array(scores))
    assert (found >= MOST_CLEAR).all()
    farther = np.array(scores)
    farther[0] += worse
    assert measure_clearness(farther)[0] >= found[0]


def test_where_nothing_else_is_comparable_thresholds_apply_as_they_are() -> None:
    assert measure_clearness(np.array([0.7])).tolist() == [1.0]
    assert measure_clearness(np.array([0.7, np.inf])).tolist() == [1.0, 1.0]
