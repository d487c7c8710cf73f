"""False alarms: a gesture like reaching is set off by reaching, figures are not."""

from app.recognition import Language, Recognizer
from app.recognition.gestures.gesture import Gesture
from app.recognition.health.false_alarms import find_false_alarms
from app.recognition.poses.sequence import PoseSequence
from app.recognition.simulation.background_motion import MANNERS, simulate_background_motion
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, infinity


def test_figures_drawn_in_the_air_are_not_set_off_by_anything() -> None:
    read = find_false_alarms(Recognizer(pool(circle=circle, infinity=infinity), "full"), 1)
    assert len(read) == len(MANNERS)
    assert sum(alarm.taken for alarm in read) <= 1


def test_a_gesture_like_an_accidental_movement_is_set_off_by_it() -> None:
    (waving,) = [
        each.trajectory for each in simulate_background_motion(1, seed=9) if each.kind == "waving"
    ]
    poses = PoseSequence(
        landmarks=waving.landmarks,
        xy=waving.xy * 100 + 300,
        time=waving.time,
        frame_size=(640, 480),
    )
    language = Language("greeting", [Gesture.from_demonstration("hello", poses)])
    read = find_false_alarms(Recognizer(language, "full"), 1, seed=9)
    assert [alarm.taken for alarm in read if alarm.kind == "waving"] == [True]
