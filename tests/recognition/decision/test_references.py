"""References: demonstrations and mirror images of a language's gestures, in one list."""

from dataclasses import replace

import numpy as np

from app.recognition import Gesture
from app.recognition.decision.references import References
from app.recognition.gestures.switches import Switches
from tests.recognition.strategies import SHAPES, recording


def references() -> References:
    """Return the references of a line shown twice, a wedge with its mirror image and a circle."""
    line, wedge, circle = (
        Gesture.from_demonstration(name, recording(SHAPES[name]))
        for name in ("line", "wedge", "circle")
    )
    line = line.with_demonstration(recording(SHAPES["line"], jitter=0.02, seed=1))
    return References.of([line, replace(wedge, switches=Switches(mirror="on")), circle])


def test_first_come_the_gestures_then_further_demonstrations_then_mirror_images() -> None:
    shown = references()
    assert [each.label for each in shown.gestures] == ["line", "wedge", "circle", "line", "wedge"]
    assert shown.owners.tolist() == [0, 1, 2, 0, 1]
    assert shown.demonstrations.tolist() == [0, 0, 0, 1, 0]
    assert shown.mirrored.tolist() == [False, False, False, False, True]


def test_each_gesture_is_as_near_as_its_nearest_reference() -> None:
    assert references().find_nearest(np.array([3.0, 2.0, np.inf, 1.0, 4.0])).tolist() == [3, 1, 2]
