"""Tuning: voters off or with a weight factor, coarser drawings, exchanged sides repaired or not."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Gesture, Language, LanguageError, OsgError, Recognizer
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.profile import Tuning
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import VOTER_NAMES
from tests.recognition.damaged_poses import with_sides_exchanged
from tests.recognition.strategies import SHAPES, circle, recording, square, wedge


@pytest.fixture(scope="module")
def language() -> Language:
    gestures = [Gesture.from_demonstration(name, recording(SHAPES[name])) for name in SHAPES]
    return Language("pool", gestures)


@pytest.mark.parametrize(("profile", "voter"), [("paper", "zernike"), ("full", "velocity")])
def test_a_voter_that_is_off_neither_votes_nor_contributes(
    language: Language, profile: str, voter: str
) -> None:
    query = recording(wedge, jitter=0.02)
    off = Recognizer(language, profile, tuning=Tuning(weights={voter: 0.0}))
    assert voter in Recognizer(language, profile).recognize(query).counted
    assert voter not in off.recognize(query).counted
    compared = off.compare(condense(Trajectory.from_poses(query)))
    assert not compared.contributions[compared.voters.index(voter)].any()


@pytest.mark.parametrize(("profile", "alone"), [("paper", "circularity"), ("full", "path")])
def test_one_voter_alone_decides(language: Language, profile: str, alone: str) -> None:
    query = recording(wedge, jitter=0.02)
    voters = Recognizer(language, profile).recognize(query).voters
    others = {voter: 0.0 for voter in voters if voter != alone}
    result = Recognizer(language, profile, tuning=Tuning(weights=others)).recognize(query)
    assert result.counted == {alone: result.label}


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


def test_profile_paper_puts_sides_right_when_told_to(language: Language) -> None:
    query = recording(circle)
    mistaken = with_sides_exchanged(query, range(20, 30))
    told = Recognizer(language, "paper", tuning=Tuning(keypoints_repaired=True))
    np.testing.assert_allclose(told.recognize(mistaken).distances, told.recognize(query).distances)
    as_it_is = Recognizer(language, "paper").recognize(mistaken)
    assert (as_it_is.distances != told.recognize(mistaken).distances).any()
    unrepaired = Recognizer(language, "full", tuning=Tuning(keypoints_repaired=False))
    assert Recognizer(language, "full").recognize(mistaken).label == "circle"
    assert unrepaired.recognize(mistaken).label != "circle"


def test_a_tuning_that_fits_nothing_is_refused(language: Language) -> None:
    with pytest.raises(OsgError, match="no voter 'psychic'"):
        Recognizer(language, "paper", tuning=Tuning(weights={"psychic": 2.0}))
    voters = Recognizer(language, "paper").recognize(recording(circle)).voters
    with pytest.raises(OsgError, match="all voters are off"):
        Recognizer(language, "paper", tuning=Tuning(weights=dict.fromkeys(voters, 0.0)))
    with pytest.raises(OsgError, match="number from 0 to 100"):
        Tuning(weights={"hu": -1.0})
    with pytest.raises(OsgError, match="number from 0 to 50"):
        Tuning(simplification=float("nan"))


def test_a_language_is_recognised_as_it_says(language: Language) -> None:
    query = recording(wedge, jitter=0.02)
    tuning = Tuning(weights={"hu": 0.0}, simplification=9.0, keypoints_repaired=True)
    tuned = replace(language, profile="paper", tuning=tuning)
    told = Recognizer(tuned).recognize(query)
    meant = Recognizer(language, "paper", tuning=tuning).recognize(query)
    assert told.profile == "paper"
    assert told.to_dict() == meant.to_dict()
    assert Recognizer(tuned, tuning=Tuning()).recognize(query).weights["hu"] > 0
    # Weights are for the voters of the language's own profile.
    other = Recognizer(tuned, "full")
    assert (other.tuning.simplification, dict(other.tuning.weights)) == (9.0, {})


def test_a_tuning_is_said_in_words() -> None:
    assert Tuning().words == "as the profile does"
    assert Tuning(weights={"hu": 1.0}).words == "as the profile does"
    tuning = Tuning(
        weights={"wrist_bend": 0.0, "hu": 2.5}, simplification=8.0, keypoints_repaired=False
    )
    assert tuning.words == (
        "without the comparison wrist bend, with 2.5 times the weight on the comparison hu, with "
        "drawings simplified by 8 pixels and with the keypoints left as the pose model saw them"
    )


TUNINGS = st.builds(
    Tuning,
    weights=st.dictionaries(st.sampled_from(VOTER_NAMES), st.floats(0.1, 100), max_size=4),
    simplification=st.floats(0, 50),
    keypoints_repaired=st.sampled_from([None, True, False]),
)


@given(tuning=TUNINGS)
def test_a_language_file_keeps_every_tuning(tuning: Tuning) -> None:
    language = Language("pool", tuning=tuning)
    again = Language.from_json(language.to_json())
    assert again.tuning == tuning
    assert again.to_json() == language.to_json()


def test_a_language_as_any_other_says_nothing_of_it() -> None:
    content = json.loads(Language("pool").to_json())
    assert {"profile", "tuning"}.isdisjoint(content)


@pytest.mark.parametrize(
    ("key", "value", "pointer"),
    [
        ("profile", "best", "/profile"),
        ("tuning", {"weights": {"hu": -1.0}}, "/tuning/weights/hu"),
        ("tuning", {"weights": {"hu": 1e9}}, "/tuning/weights/hu"),
        ("tuning", {"weights": {"psychic": 1.0}}, "/tuning/weights"),
        ("tuning", {"weights": dict.fromkeys(VOTER_NAMES, 0.0)}, "/tuning/weights"),
        ("tuning", {"simplification": "fine"}, "/tuning/simplification"),
        ("tuning", {"keypoints_repaired": 1}, "/tuning/keypoints_repaired"),
        ("tuning", {"gain": 3}, "/tuning/gain"),
    ],
)
def test_a_tuning_that_makes_no_sense_is_refused_by_its_place(
    key: str, value: object, pointer: str
) -> None:
    content = json.loads(Language("pool").to_json())
    del content["sha256"]
    with pytest.raises(LanguageError) as refusal:
        Language.from_json(json.dumps(content | {key: value}))
    assert refusal.value.pointer == pointer
