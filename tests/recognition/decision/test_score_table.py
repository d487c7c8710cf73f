"""A score's parts: they add up to the score that decides."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from app.recognition import Language, PoseSequence, Recognizer
from app.recognition.decision.result import ScoreTable
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.profile import PROFILES
from app.recognition.gestures.switches import Switches
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.demonstrations import drawn_language, drawn_recognizer
from tests.recognition.strategies import SHAPES, line, recording, recordings


def compared(recognizer: Recognizer, poses: PoseSequence) -> ScoreTable:
    return recognizer.compare(condense(Trajectory.from_poses(poses)))


@pytest.mark.parametrize("profile", PROFILES)
@given(recordings())
def test_the_distances_are_those_of_the_recognition(profile: str, query: PoseSequence) -> None:
    comparison = compared(drawn_recognizer(profile), query)
    result = drawn_recognizer(profile).recognize(query)
    assert comparison.voters == result.voters
    np.testing.assert_array_equal(comparison.distances, result.distances)


@given(recordings())
def test_the_smallest_score_wins_in_profile_full(query: PoseSequence) -> None:
    scores = compared(drawn_recognizer("full"), query).scores
    nearest = drawn_recognizer("full").recognize(query).nearest
    assert drawn_language().labels[int(scores.argmin())] == nearest


def test_a_figure_read_backwards_costs_half_as_much_again() -> None:
    comparison = compared(drawn_recognizer("full"), recording(lambda share: line(1 - share)))
    at = drawn_language().labels.index("line")
    traversal = comparison.traversals[at]
    assert traversal is not None
    assert traversal.backward
    assert comparison.turned[at] == pytest.approx(comparison.contributions[:, at].sum() / 2)


def test_the_mirror_image_that_fits_is_named() -> None:
    gestures = [
        replace(gesture, switches=Switches(mirror="on")) if gesture.label == "wedge" else gesture
        for gesture in drawn_language().gestures
    ]
    recognizer = Recognizer(Language("pool", gestures), "full")
    shown = PoseSequence(
        landmarks=(query := recording(SHAPES["wedge"])).landmarks,
        xy=query.xy,
        time=query.time,
        frame_size=query.frame_size,
    )
    assert not compared(recognizer, shown).mirrored.any()
    trajectory = condense(Trajectory.from_poses(shown)).mirror()
    assert recognizer.compare(trajectory).mirrored.tolist() == [
        label == "wedge" for label in drawn_language().labels
    ]
