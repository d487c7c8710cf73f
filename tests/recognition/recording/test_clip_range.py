"""Which part of a recording a range means, without a server."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.recognition.errors import AmbiguousRangeError, RangeError
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recording import clip_range
from app.recognition.recording.clip_range import find_clip_range, find_surroundings
from app.recognition.recording.segmentation import Bracket, Take, cut_take, takes_in
from tests.api.recordings import recording_of


def test_a_range_from_salute_to_salute_means_the_stroke_between() -> None:
    recording = recording_of("circle", "line")
    take = takes_in(recording)[1]
    assert find_clip_range(recording, take.start, take.end).poses == take.poses
    whole = find_clip_range(recording, take.start, take.end, keep_transit=True)
    assert (whole.start, whole.end, whole.poses) == (take.start, take.end, take.untrimmed)


def test_of_the_takes_only_the_one_that_is_meant_is_trimmed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    recording = recording_of("circle", "line", "circle")
    take = takes_in(recording)[1]
    trimmed: list[Bracket] = []

    def trim(poses: PoseSequence, bracket: Bracket, **options: Any) -> Take:
        trimmed.append(bracket)
        return cut_take(poses, bracket, **options)

    monkeypatch.setattr(clip_range, "cut_take", trim)
    find_clip_range(recording, take.start, take.end)
    find_clip_range(recording, take.start, take.end - 0.1)
    find_surroundings(recording, take.start, take.end)
    assert [(bracket.start, bracket.end) for bracket in trimmed] == [(take.start, take.end)]


def test_without_a_range_the_only_take_is_meant() -> None:
    recording = recording_of("circle")
    (take,) = takes_in(recording)
    found = find_clip_range(recording)
    assert (found.start, found.end) == (take.stroke_start, take.stroke_end)
    assert found.poses == take.poses


def test_a_range_from_salute_to_salute_may_be_rounded_to_milliseconds() -> None:
    recording = recording_of("circle", "line")
    take = takes_in(recording)[1]
    found = find_clip_range(recording, round(take.start, 3), round(take.end, 3))
    assert found.poses == take.poses


def test_any_other_range_is_taken_as_it_is() -> None:
    recording = recording_of("circle")
    found = find_clip_range(recording, 1.0, 2.0)
    assert (found.start, found.end) == (1.0, 2.0)
    np.testing.assert_allclose(found.poses.time[[0, -1]], [1.0, 2.0])


def test_an_open_range_goes_to_the_clips_end() -> None:
    recording = recording_of("circle")
    found = find_clip_range(recording, start=1.0)
    assert found.end == recording.poses.time[-1]
    assert find_clip_range(recording, end=1.0).start == 0.0


def test_a_clip_in_which_nobody_salutes_is_meant_whole() -> None:
    recording = recording_of()
    assert find_clip_range(recording).poses == recording.poses


def test_several_takes_are_listed_for_the_choice() -> None:
    with pytest.raises(AmbiguousRangeError, match=r"2 takes \(0\.") as caught:
        find_clip_range(recording_of("circle", "line"))
    assert caught.value.pointer == ""


@pytest.mark.parametrize(("start", "end"), [(2.0, 1.0), (1.0, 1.0), (90.0, 91.0), (90.0, None)])
def test_a_range_without_frames_is_refused(start: float, end: float | None) -> None:
    with pytest.raises(RangeError, match="no frames lie between") as caught:
        find_clip_range(recording_of("circle"), start, end)
    assert caught.value.pointer == "/start"


def test_of_an_open_range_without_frames_the_end_is_to_be_mended() -> None:
    with pytest.raises(RangeError, match="no frames lie between 0 s and -1 s") as caught:
        find_clip_range(recording_of("circle"), end=-1.0)
    assert caught.value.pointer == "/end"


def test_a_range_was_cut_out_of_the_take_around_it_or_of_the_clip() -> None:
    recording = recording_of("circle", "line")
    take = takes_in(recording)[0]
    middle = (take.start + take.end) / 2
    assert find_surroundings(recording, middle, take.end) == take.untrimmed
    assert find_surroundings(recording, 0.0, recording.poses.time[-1]) == recording.poses
