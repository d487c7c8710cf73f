"""What a language needs is what its gestures follow."""

from app.recognition import Gesture, Language
from app.recognition.requirements import requirements_of
from tests.recognition.strategies import circle, line, recording


def test_a_language_needs_the_landmarks_its_gestures_follow() -> None:
    language = Language(
        "pool",
        [
            Gesture.from_demonstration("circle", recording(circle)),
            Gesture.from_demonstration("left line", recording(line, hand="left_wrist")),
        ],
    )
    needed = requirements_of(language)
    assert needed.salient == ("left_wrist", "right_wrist")
    assert not set(needed.limbs) & {*needed.salient, *needed.torso}
    assert set(needed.torso) == {"left_shoulder", "right_shoulder", "left_hip", "right_hip"}
    assert "pose_landmark_full" in needed.models


def test_an_empty_language_needs_no_landmark_of_a_gesture() -> None:
    needed = requirements_of(Language("empty"))
    assert needed.salient == needed.limbs == ()
