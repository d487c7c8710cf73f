"""Direction marks: where a path begins and which way it goes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.recognition import Gesture
from app.recognition.features.trajectory_image import SIZE
from app.recognition.recording.segmentation import takes_in
from app.ui.charts import mark_direction, mark_gesture
from tests.api.recordings import recording_of


def gesture_of(shape: str) -> Gesture:
    """Return a gesture of one of the test recordings."""
    (take,) = takes_in(recording_of(shape))
    return Gesture.from_demonstration(shape, take.poses)


def marked_places(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.intp]:
    """Return ``(N, 2)`` x and y of the coloured pixels: marks, not strokes."""
    coloured = np.ptp(image.astype(int), axis=2) > 60
    return np.argwhere(coloured)[:, ::-1]


def test_the_dot_is_at_the_start_of_the_path() -> None:
    # The line goes from the left to the right.
    line = marked_places(mark_gesture(gesture_of("line")))
    assert len(line)
    assert line[:, 0].min() < 0.1 * SIZE
    assert line[:, 0].max() < 0.5 * SIZE


def test_the_same_figure_the_other_way_round_is_marked_differently() -> None:
    forth = mark_gesture(gesture_of("circle"))
    back = mark_gesture(gesture_of("circle backwards"))
    forth_x, back_x = (np.median(marked_places(each)[:, 0]) for each in (forth, back))
    assert abs(forth_x - back_x) > 10


def test_without_a_demonstration_there_are_no_marks() -> None:
    image = gesture_of("line").image
    assert not len(marked_places(mark_direction(image, None)))
