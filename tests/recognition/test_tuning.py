"""Tuning: voters off or weighed, coarser drawings, sides put right or not."""

import numpy as np
import pytest

from app.recognition import Gesture, Language, RecognitionError, Recognizer
from app.recognition.gesture import condensed
from app.recognition.landmarks import other_side
from app.recognition.poses import PoseSequence
from app.recognition.trajectory import Trajectory
from app.recognition.tuning import Tuning
from tests.recognition.strategies import SHAPES, circle, recording, square, wedge


@pytest.fixture(scope="module")
def language() -> Language:
    gestures = [Gesture.from_demonstration(name, recording(SHAPES[name])) for name in SHAPES]
    return Language("pool", gestures)


@pytest.mark.parametrize("profile", ["paper", "full"])
def test_a_voter_that_is_off_neither_votes_nor_contributes(
    language: Language, profile: str
) -> None:
    query = recording(wedge, jitter=0.02)
    off = Recognizer(language, profile, tuning=Tuning(weights={"zernike": 0.0}))
    assert "zernike" in Recognizer(language, profile).recognize(query).counted
    assert "zernike" not in off.recognize(query).counted
    compared = off.compare(condensed(Trajectory.from_poses(query)))
    assert not compared.contributions[compared.voters.index("zernike")].any()


@pytest.mark.parametrize("profile", ["paper", "full"])
def test_one_voter_alone_decides(language: Language, profile: str) -> None:
    query = recording(wedge, jitter=0.02)
    voters = Recognizer(language, profile).recognize(query).voters
    others = {voter: 0.0 for voter in voters if voter != "circularity"}
    result = Recognizer(language, profile, tuning=Tuning(weights=others)).recognize(query)
    assert result.counted == {"circularity": result.label}


def test_weights_count_as_so_many_votes(language: Language) -> None:
    query = recording(square, jitter=0.03)
    plain = Recognizer(language, "paper").recognize(query)
    for voter, vote in plain.votes.items():
        tuning = Tuning(weights={voter: 100.0})
        tuned = Recognizer(language, "paper", tuning=tuning).recognize(query)
        assert tuned.label == vote


def test_equal_weights_change_nothing(language: Language) -> None:
    query = recording(circle, jitter=0.02)
    for profile in ("paper", "full"):
        plain = Recognizer(language, profile).recognize(query)
        same = Recognizer(language, profile, tuning=Tuning(weights=dict.fromkeys(plain.voters, 2)))
        assert same.recognize(query).confidence == pytest.approx(plain.confidence)


def test_references_and_queries_are_drawn_alike(language: Language) -> None:
    coarse = Recognizer(language, "paper", tuning=Tuning(simplification=30.0))
    for name, shape in SHAPES.items():
        result = coarse.recognize(recording(shape))
        assert result.distances[:, result.gestures.index(name)].max() == 0.0
    fine = Recognizer(language, "paper").recognize(recording(circle, jitter=0.03))
    assert (coarse.recognize(recording(circle, jitter=0.03)).distances != fine.distances).any()


def with_sides_exchanged(poses: PoseSequence, frames: slice) -> PoseSequence:
    xy = poses.xy.copy()
    others = [
        poses.landmarks.index(other) if (other := other_side(name)) in poses.landmarks else index
        for index, name in enumerate(poses.landmarks)
    ]
    xy[frames] = xy[frames][:, others]
    return PoseSequence(
        landmarks=poses.landmarks, xy=xy, time=poses.time, frame_size=poses.frame_size
    )


def test_profile_paper_puts_sides_right_when_told_to(language: Language) -> None:
    query = recording(circle)
    mistaken = with_sides_exchanged(query, slice(20, 30))
    told = Recognizer(language, "paper", tuning=Tuning(keypoints_repaired=True))
    np.testing.assert_allclose(told.recognize(mistaken).distances, told.recognize(query).distances)
    as_it_is = Recognizer(language, "paper").recognize(mistaken)
    assert (as_it_is.distances != told.recognize(mistaken).distances).any()
    unrepaired = Recognizer(language, "full", tuning=Tuning(keypoints_repaired=False))
    assert Recognizer(language, "full").recognize(mistaken).label == "circle"
    assert unrepaired.recognize(mistaken).label != "circle"


def test_a_tuning_that_fits_nothing_is_refused(language: Language) -> None:
    with pytest.raises(RecognitionError, match="no voter 'psychic'"):
        Recognizer(language, "paper", tuning=Tuning(weights={"psychic": 2.0}))
    voters = Recognizer(language, "paper").recognize(recording(circle)).voters
    with pytest.raises(RecognitionError, match="all voters are off"):
        Recognizer(language, "paper", tuning=Tuning(weights=dict.fromkeys(voters, 0.0)))
    with pytest.raises(RecognitionError, match="number from 0 up"):
        Tuning(weights={"hu": -1.0})
    with pytest.raises(RecognitionError, match="number from 0 up"):
        Tuning(simplification=float("nan"))
