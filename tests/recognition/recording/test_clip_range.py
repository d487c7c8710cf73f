"""Which part of a recording a range means, without a server."""

from __future__ import annotations

from typing import Any

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


def test_a_range_that_means_nothing_is_refused() -> None:
    recording = recording_of("circle", "line")
    with pytest.raises(AmbiguousRangeError, match="2 takes"):
        find_clip_range(recording)
    with pytest.raises(RangeError, match="no frames lie between 90 s"):
        find_clip_range(recording, 90.0, 91.0)


def test_a_range_was_cut_out_of_the_take_around_it_or_of_the_clip() -> None:
    recording = recording_of("circle", "line")
    take = takes_in(recording)[0]
    middle = (take.start + take.end) / 2
    assert find_surroundings(recording, middle, take.end) == take.untrimmed
    assert find_surroundings(recording, 0.0, recording.poses.time[-1]) == recording.poses
