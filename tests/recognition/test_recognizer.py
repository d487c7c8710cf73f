"""Recognition: similar movements of any diver are recognised, and results can be inspected."""

import json
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import (
    Gesture,
    Language,
    LanguageError,
    OsgError,
    PoseError,
    PoseSequence,
    Recognition,
    Recognizer,
)
from app.recognition.decision.majority_vote import MajorityVote, weigh_relative_distances
from app.recognition.features.trajectory_image import Drawing, draw
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import PAPER_VOTERS, VOTER_NAMES
from tests.recognition.held_takes import FIST, FLAT, TWO, hold
from tests.recognition.parametric_hand import Fingers
from tests.recognition.strategies import SHAPES, circle, line, recording, recordings, rest, wedge

VOTERS = (
    "hu",
    "zernike",
    "fourier",
    "aspect_ratio",
    "solidity",
    "circularity",
    "path_complexity",
)


@pytest.fixture(scope="module")
def language() -> Language:
    return Language(
        "pool",
        [Gesture.from_demonstration(name, recording(shape)) for name, shape in SHAPES.items()],
    )


@pytest.fixture(scope="module")
def recognizer(language: Language) -> Recognizer:
    return Recognizer(language, profile="paper")


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("seed", range(3))
def test_another_diver_elsewhere_is_recognised(
    recognizer: Recognizer, name: str, seed: int
) -> None:
    query = recording(
        SHAPES[name], frames=95, rate=25, torso=60, centre=(200, 300), jitter=0.01, seed=seed
    )
    result = recognizer.recognize(query)
    assert result.label == result.nearest == name


def test_a_result_has_what_is_needed_to_question_it(recognizer: Recognizer) -> None:
    result = recognizer.recognize(recording(wedge, jitter=0.01))
    assert result.profile == "paper"
    assert result.voters == VOTERS
    assert result.gestures == tuple(SHAPES)
    assert result.distances.shape == (len(VOTERS), len(SHAPES))
    assert tuple(result.votes) == VOTERS
    assert list(result.weights.values()) == [1 / 7] * 7
    for row, voter in enumerate(VOTERS):
        assert result.votes[voter] == result.gestures[result.distances[row].argmin()]


def test_the_demonstration_itself_is_at_distance_zero(recognizer: Recognizer) -> None:
    result = recognizer.recognize(recording(circle))
    np.testing.assert_array_equal(result.distances[:, 0], 0.0)
    assert result.confidence == 1.0


@given(
    poses=recordings(),
    scale=st.floats(0.2, 5.0),
    shift=st.tuples(st.floats(-300, 300), st.floats(-300, 300)),
    offset=st.floats(-100, 100),
)
def test_place_size_and_clock_change_no_distance(
    recognizer: Recognizer,
    poses: PoseSequence,
    scale: float,
    shift: tuple[float, float],
    offset: float,
) -> None:
    elsewhere = replace(poses, xy=poses.xy * scale + shift, time=poses.time + offset)
    before, after = recognizer.recognize(poses), recognizer.recognize(elsewhere)
    np.testing.assert_array_equal(after.distances, before.distances)


@pytest.mark.parametrize("name", SHAPES)
def test_twice_the_frame_rate_changes_less_than_another_gesture_would(
    recognizer: Recognizer, name: str
) -> None:
    at_30 = recognizer.recognize(recording(SHAPES[name], frames=45, rate=30))
    at_60 = recognizer.recognize(recording(SHAPES[name], frames=90, rate=60))
    own = at_30.gestures.index(name)
    assert at_60.label == at_30.label == name
    changes = np.abs(at_60.distances - at_30.distances)[:, own]
    others = np.delete(at_30.distances, own, axis=1).mean(axis=1)
    assert (changes < others / 2).all()


@given(recordings())
def test_any_stroke_gets_a_label_a_confidence_and_plain_json(
    recognizer: Recognizer, poses: PoseSequence
) -> None:
    result = recognizer.recognize(poses)
    assert result.label in SHAPES
    assert 0.0 <= result.confidence <= 1.0
    assert (result.distances >= 0).all()
    assert json.loads(json.dumps(result.to_dict(), allow_nan=False)) == result.to_dict()


def test_the_order_of_gestures_does_not_decide(language: Language) -> None:
    turned = Recognizer(Language("turned", tuple(reversed(language.gestures))))
    for shape in SHAPES.values():
        query = recording(shape, jitter=0.03, seed=9, frames=40)
        assert turned.recognize(query).label == Recognizer(language).recognize(query).label


def test_a_gesture_whose_keypoints_the_query_lacks_is_infinitely_far(language: Language) -> None:
    left = Gesture.from_demonstration("left", recording(circle, hand="left_wrist"))
    recognizer = Recognizer(language.with_gesture(left))
    query = recording(wedge, jitter=0.01)
    without = query.select([name for name in query.landmarks if name != "left_wrist"])
    hidden = query.xy.copy()
    hidden[:, query.landmarks.index("left_wrist")] = np.nan
    for poses in (query, without, replace(query, xy=hidden)):
        result = recognizer.recognize(poses)
        assert result.label == "wedge"
        assert np.isinf(result.distances[:, -1]).all()
        assert result.to_dict()["distances"][0][-1] is None


def test_a_recording_of_nobody_is_refused(recognizer: Recognizer) -> None:
    poses = recording(circle)
    with pytest.raises(PoseError, match="none of the 60 frames shows a landmark"):
        recognizer.recognize(replace(poses, xy=np.full_like(poses.xy, np.nan)))
    with pytest.raises(PoseError, match="none of the 0 frames"):
        recognizer.recognize(recording(circle, frames=0))


def test_a_recording_in_which_nothing_moves_is_refused(recognizer: Recognizer) -> None:
    for still in (recording(rest), recording(circle, frames=1)):
        with pytest.raises(PoseError, match=r"need \(right_wrist\) moves in this take"):
            recognizer.recognize(still)


def test_an_empty_language_cannot_recognise() -> None:
    with pytest.raises(LanguageError, match="'pool' has no gestures yet: add one"):
        Recognizer(Language("pool"))


def test_an_unknown_profile_is_named_with_the_known_ones(language: Language) -> None:
    with pytest.raises(OsgError, match=r"no profile 'best'; .* paper and full"):
        Recognizer(language, profile="best")


def test_a_gesture_that_matches_nothing_disturbs_no_other(language: Language) -> None:
    blank = Gesture(label="blank", salient=("right_wrist",), image=np.zeros((224, 224), np.uint8))
    unlinked = Gesture(label="unlinked", salient=(), image=language.gestures[0].image)
    broken = Language("pool", [blank, *language.gestures, unlinked])
    query = recording(wedge, jitter=0.02)
    result = Recognizer(broken).recognize(query)
    expected = Recognizer(language).recognize(query)
    assert result.label == "wedge"
    np.testing.assert_array_equal(result.distances[:, 1:-1], expected.distances)
    assert result.confidence == expected.confidence
    with pytest.raises(PoseError, match="nothing to compare"):
        Recognizer(Language("broken", [blank])).recognize(query)


def test_a_language_of_one_gesture_recognises_it() -> None:
    alone = Recognizer(Language("one", [Gesture.from_demonstration("line", recording(line))]))
    assert alone.recognize(recording(line, frames=33, jitter=0.01)).label == "line"


def test_gestures_without_stored_descriptors_are_described_when_needed(language: Language) -> None:
    bare = [replace(gesture, descriptors={}) for gesture in language.gestures]
    query = recording(wedge, jitter=0.02)
    np.testing.assert_array_equal(
        Recognizer(Language("bare", bare)).recognize(query).distances,
        Recognizer(language).recognize(query).distances,
    )


def test_a_query_is_drawn_once_per_set_of_keypoints_not_once_per_gesture(
    language: Language, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = Gesture.from_demonstration("left", recording(circle, hand="left_wrist"))
    many = [
        replace(gesture, label=f"{gesture.label} {n}")
        for gesture in language.gestures
        for n in range(10)
    ]
    recognizer = Recognizer(Language("many", [*many, left]), "paper")
    drawn: list[tuple[str, ...]] = []

    def noted(trajectory: Trajectory, simplification: float) -> Drawing:
        drawn.append(trajectory.landmarks)
        return draw(trajectory, simplification)

    monkeypatch.setattr("app.recognition.decision.majority_vote.draw", noted)
    recognizer.recognize(recording(circle))
    assert sorted(drawn) == [("left_wrist",), ("right_wrist",)]


def test_relative_distances_put_voters_on_one_scale() -> None:
    never = [np.inf] * 3  # a voter that abstains has no weight
    distances = np.array([[1.0, 3.0, np.inf], [100.0, 300.0, np.inf], [0.0, 0.0, np.inf], never])
    contributions = weigh_relative_distances(distances, np.ones(4))
    np.testing.assert_allclose(contributions.sum(axis=0), [1 / 3, 1.0, np.inf])
    assert contributions[3].tolist() == [0.0, 0.0, 0.0]


def counted(recognizer: Recognizer, distances: FloatArray) -> Recognition:
    assert isinstance(recognizer.vote, MajorityVote)
    return recognizer.vote.count_votes(distances)


def test_where_the_votes_and_the_distances_disagree_confidence_is_the_share_of_votes(
    recognizer: Recognizer,
) -> None:
    distances = np.full((len(PAPER_VOTERS), len(SHAPES)), 10.0)
    distances[:4, 0] = 9.0
    distances[4:, 1] = 0.1
    result = counted(recognizer, distances)
    assert result.label == "circle"
    assert result.confidence == pytest.approx(4 / 7 / 2)


@lru_cache
def moving_and_held() -> Language:
    around = np.linspace(0, 2 * np.pi, 40)
    circle = hold(FLAT, moving=0.4 * np.column_stack([np.cos(around), np.sin(around)]))
    line = hold(FLAT, moving=np.column_stack([np.linspace(0, 1, 40), np.zeros(40)]))
    return Language(
        name="mixed",
        gestures=[
            Gesture.from_demonstration("circle", circle),
            Gesture.from_demonstration("line", line),
            Gesture.from_demonstration("stop", hold(FLAT)),
            Gesture.from_demonstration("fist", hold(FIST)),
            Gesture.from_demonstration("two", hold(TWO)),
        ],
    )


@pytest.mark.parametrize(("label", "shape"), [("stop", FLAT), ("fist", FIST), ("two", TWO)])
@pytest.mark.parametrize("left", [False, True])
def test_a_held_hand_shape_is_recognised_from_one_demonstration(
    label: str, shape: Fingers, left: bool
) -> None:
    result = Recognizer(moving_and_held()).recognize(hold(shape, roll=8, yaw=10, seed=3, left=left))
    assert result.label == label
    assert set(result.votes) == {"hand_landmarks", "finger_directions", "fingertip_distances"}
    assert sum(result.weights.values()) == pytest.approx(1)
    assert Recognition.from_dict(result.to_dict()).votes == dict(result.votes)


def test_a_shape_that_is_no_gesture_is_rejected() -> None:
    result = Recognizer(moving_and_held()).recognize(hold(FLAT, roll=180))
    assert result.label is None


def test_a_movement_is_read_as_without_held_shapes() -> None:
    language = moving_and_held()
    moving = replace(language, gestures=language.gestures[:2])
    around = np.linspace(0, 2 * np.pi, 40)
    ellipse = hold(FIST, moving=0.4 * np.column_stack([np.cos(around), 0.8 * np.sin(around)]))
    alone, among = (Recognizer(each).recognize(ellipse) for each in (moving, language))
    assert among.label == alone.label == "circle"
    assert among.confidence == alone.confidence
    assert np.array_equal(among.distances[: len(VOTER_NAMES), :2], alone.distances)
    assert np.isinf(among.distances[:, 2:]).all()


def test_a_small_movement_stays_one_beside_held_shapes() -> None:
    there = 0.14 * np.sin(np.linspace(0, 2 * np.pi, 40))
    nod = hold(FLAT, moving=np.column_stack([0 * there, there]))
    language = moving_and_held()
    small = Gesture.from_demonstration("nod", nod, salient=["right_wrist"])
    gestures = [small, *language.gestures]
    assert Recognizer(language).query(nod).hands
    assert Recognizer(replace(language, gestures=gestures)).recognize(nod).label == "nod"
    still = Recognizer(replace(language, gestures=gestures)).recognize(hold(FLAT))
    assert still.label == Recognizer(language).recognize(hold(FLAT)).label != "nod"


def test_a_still_take_without_hands_says_what_is_missing() -> None:
    held = Language(name="held", gestures=moving_and_held().gestures[2:])
    with pytest.raises(PoseError, match="no hand is seen in this take that holds a shape"):
        Recognizer(held).recognize(replace(hold(FLAT), hands=None))
