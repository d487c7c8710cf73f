"""Clip takes: the part of a clip that a request refers to."""

import numpy as np
import pytest

from app.api.http.problems import ProblemError
from app.api.services.clip_takes import clip_range_in
from app.recognition.recording.segmentation import takes_in
from tests.api.recordings import recording_of


def test_without_a_range_the_only_take_is_meant() -> None:
    recording = recording_of("circle")
    (take,) = takes_in(recording)
    found = clip_range_in(recording)
    assert (found.start, found.end) == (take.stroke_start, take.stroke_end)
    assert found.poses == take.poses


def test_a_range_from_salute_to_salute_may_be_rounded_to_milliseconds() -> None:
    recording = recording_of("circle", "line")
    take = takes_in(recording)[1]
    found = clip_range_in(recording, round(take.start, 3), round(take.end, 3))
    assert found.poses == take.poses


def test_any_other_range_is_taken_as_it_is() -> None:
    recording = recording_of("circle")
    found = clip_range_in(recording, 1.0, 2.0)
    assert (found.start, found.end) == (1.0, 2.0)
    np.testing.assert_allclose(found.poses.time[[0, -1]], [1.0, 2.0])


def test_an_open_range_goes_to_the_clips_end() -> None:
    recording = recording_of("circle")
    found = clip_range_in(recording, start=1.0)
    assert found.end == recording.poses.time[-1]
    assert clip_range_in(recording, end=1.0).start == 0.0


def test_a_clip_in_which_nobody_salutes_is_meant_whole() -> None:
    recording = recording_of()
    assert clip_range_in(recording).poses == recording.poses


def test_several_takes_are_listed_for_the_choice() -> None:
    with pytest.raises(ProblemError, match=r"2 takes \(0\.") as caught:
        clip_range_in(recording_of("circle", "line"))
    assert caught.value.code == "take_ambiguous"


@pytest.mark.parametrize(("start", "end"), [(2.0, 1.0), (1.0, 1.0), (90.0, 91.0), (90.0, None)])
def test_a_range_without_frames_is_refused(start: float, end: float | None) -> None:
    with pytest.raises(ProblemError, match="no frames lie between") as caught:
        clip_range_in(recording_of("circle"), start, end)
    assert caught.value.code == "range_empty"
