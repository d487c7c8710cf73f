"""From a clip to a recording: every frame counted, nothing invented, cancelled at once."""

from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from app.recognition.errors import VideoError
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.frame import Body, FrameLandmarks, Hand, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.extraction import (
    FIRST_SECONDS,
    extract_poses,
    record,
)
from app.recognition.recording.recording import Recording
from app.recognition.recording.segmentation import takes_in
from app.recognition.recording.video import VideoFrame
from languages.render.encode import encode
from tests.recognition.damaged_clips import HEIGHT, WIDTH, cut_off, write_clip
from tests.recognition.parametric_hand import hand_xy, salute

FLAT_HAND = np.zeros((21, 2))


class ScriptedEstimator:
    """An estimator with given results: a body in all but some frames, a salute in some of them.

    It replaces the models in tests of the processing of their results.
    """

    def __init__(
        self,
        *,
        bodiless: frozenset[int] = frozenset(),
        saluting: frozenset[int] = frozenset(),
        with_flat_hand: frozenset[int] = frozenset(),
        unseen: int | None = None,
    ) -> None:
        self.bodiless, self.saluting, self.unseen = bodiless, saluting, unseen
        self.with_flat_hand = with_flat_hand
        self.times: list[float] = []
        self.closed = False

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        assert image.shape == (HEIGHT, WIDTH, 3)
        index = len(self.times)
        self.times.append(time)
        xy = np.tile([[float(index), 10.0]], (33, 1))
        if self.unseen is not None:
            xy[self.unseen] = [np.inf, 5.0]
        body = None if index in self.bodiless else Body(xy, np.full(33, 0.9), 0.9)
        hands: tuple[Hand, ...] = ()
        if index in self.saluting:
            small, large = hand_xy(salute()), 5 * FLAT_HAND + np.arange(21)[:, None]
            hands = (Hand(small, "right", 0.9), Hand(large, "left", 0.9))
        elif index in self.with_flat_hand:
            hands = (Hand(FLAT_HAND, "right", 0.9),)
        return FrameLandmarks(body, hands)

    def reset(self) -> None:
        self.times.clear()

    def close(self) -> None:
        self.closed = True


class SeeingEstimator(ScriptedEstimator):
    """Notes the range of grey levels of every image it is shown."""

    def __init__(self) -> None:
        super().__init__()
        self.ranges: list[float] = []

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        self.ranges.append(float(np.ptp(image)))
        return super().estimate(image, time)


class GlovedEstimator(ScriptedEstimator):
    """Sees a hand in every frame, without its fingers."""

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        xy = np.full((21, 2), np.nan)
        xy[[0, 5, 9, 13, 17]] = FLAT_HAND[[0, 5, 9, 13, 17]]
        return replace(super().estimate(image, time), places=(Hand(xy, "right", 0.9),))


@pytest.fixture
def murky_clip(tmp_path: Path) -> Path:
    """Return a clip of a slope from one grey to another a little lighter one."""
    slope = np.linspace(90, 120, WIDTH).astype(np.uint8)
    image = np.tile(slope[None, :, None], (HEIGHT, 1, 3))
    file = tmp_path / "murky.mp4"
    file.write_bytes(encode([image] * 3, rate=25, rate_factor=18))
    return file


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    return write_clip(tmp_path / "clip.mp4", frames=20)


def test_every_frame_is_recorded_with_its_time(clip: Path) -> None:
    estimator = ScriptedEstimator(saluting=frozenset(range(20)))
    recording = record(clip, estimator=estimator)
    assert recording.poses.landmarks == POSE_LANDMARKS
    assert recording.poses.frame_size == (WIDTH, HEIGHT)
    assert recording.poses.time == pytest.approx(np.arange(20) / 25)
    assert recording.poses.time.tolist() == estimator.times
    assert (recording.salute > 0.5).all()
    assert recording.warnings == ()
    assert not estimator.closed


def test_murky_frames_are_corrected_before_anything_is_looked_for(murky_clip: Path) -> None:
    ranges = {}
    for water in get_args(WaterCorrection):
        estimator = SeeingEstimator()
        record(murky_clip, estimator=estimator, water=water)
        ranges[water] = max(estimator.ranges)
    assert ranges["off"] < 50
    assert ranges["on"] > 200
    assert ranges["auto"] == ranges["on"]


def test_the_larger_hand_comes_first(clip: Path) -> None:
    recording = record(clip, estimator=ScriptedEstimator(saluting=frozenset({0})))
    assert [hand.side for hand in recording.hands[0]] == ["left", "right"]


@pytest.mark.withstands(row="H11")
def test_frames_without_a_person_stay_and_are_counted(clip: Path) -> None:
    bodiless = frozenset({0, 7, 8})
    recording = record(
        clip, estimator=ScriptedEstimator(bodiless=bodiless, saluting=frozenset({1, 2}))
    )
    assert np.flatnonzero(~recording.poses.seen.any(axis=1)).tolist() == sorted(bodiless)
    assert recording.poses.confidence is not None
    assert (recording.poses.confidence[7] == 0).all()
    assert recording.warnings == ("no person in 3 of 20 frames",)


def test_a_clip_without_anybody_is_no_silent_success(clip: Path) -> None:
    recording = record(clip, estimator=ScriptedEstimator(bodiless=frozenset(range(20))))
    assert not recording.poses.seen.any()
    assert recording.warnings[0] == "no person in 20 of 20 frames"
    assert "no hand in any of 20 frames" in recording.salute_warnings[0]
    assert takes_in(recording) == ()


def test_a_clip_in_which_fingers_cannot_be_told_advises_a_trigger_of_the_arms(clip: Path) -> None:
    few = record(clip, estimator=ScriptedEstimator(with_flat_hand=frozenset({3, 9})))
    assert few.salute_warnings == (
        "hands seen in 10% of 20 frames: choose a trigger of the arms, or film from nearer",
    )
    many = record(clip, estimator=ScriptedEstimator(with_flat_hand=frozenset(range(20))))
    assert "no salute in any of 20 frames" in many.salute_warnings[0]


def test_a_clip_of_gloves_tells_that_hands_are_seen_and_fingers_are_not(clip: Path) -> None:
    gloved = record(clip, estimator=GlovedEstimator(with_flat_hand=frozenset({3})))
    assert gloved.salute_warnings == (
        "hands seen in 100% of 20 frames, their fingers in 5%: gloves? Choose a trigger of the "
        "arms",
    )
    assert sum(map(bool, gloved.hands)) == 1


@pytest.mark.withstands(row="H11")
def test_a_landmark_that_is_no_number_becomes_unseen(clip: Path) -> None:
    poses = extract_poses(clip, estimator=ScriptedEstimator(unseen=5))
    assert not poses.seen[:, 5].any()
    assert poses.seen[:, :5].all()


class CrowdedEstimator(ScriptedEstimator):
    """Follows a buddy; from frame 5 on there is another body, whose hand salutes."""

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        found = super().estimate(image, time)
        index = len(self.times) - 1
        grid: FloatArray = np.array([[8.0 * (each % 5), 8.0 * (each // 5)] for each in range(33)])
        buddy = Body(grid, np.full(33, 0.9), 0.9)
        if index < 5:
            return FrameLandmarks(buddy, ())
        diver = Body(grid + np.array([200.0, 0.0]), np.full(33, 0.9), 0.9)
        wrist = POSE_LANDMARKS.index("right_wrist")
        hands = tuple(
            Hand(hand.xy - hand.xy[0] + diver.xy[wrist], hand.side, hand.score)
            for hand in found.hands
        )
        return FrameLandmarks(buddy, hands, (diver,))


def test_the_body_of_the_saluting_hand_is_recorded_and_the_choice_is_told(clip: Path) -> None:
    recording = record(clip, estimator=CrowdedEstimator(saluting=frozenset(range(6, 18))))
    seen = recording.poses.seen.all(axis=1)
    assert seen.tolist() == [False] * 5 + [True] * 15
    assert recording.poses.xy[5:, 0, 0].tolist() == [200.0] * 15
    assert recording.people is not None
    assert recording.people.tolist() == [1] * 5 + [2] * 15
    assert recording.warnings == (
        "two people are seen; the body is that of the diver who salutes",
        "that person is not seen in 5 of 20 frames",
    )


def test_progress_counts_up_to_the_end(clip: Path) -> None:
    calls: list[tuple[int, int]] = []
    record(
        clip,
        estimator=ScriptedEstimator(),
        progress=lambda done, total: calls.append((done, total)),
    )
    assert calls[-1] == (20, 20)
    assert [done for done, _ in calls] == sorted(done for done, _ in calls)
    assert all(done <= total for done, total in calls)


def test_progress_estimates_the_count_where_the_container_has_none(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mkv", frames=20)
    totals: list[int] = []
    record(clip, estimator=ScriptedEstimator(), progress=lambda _, total: totals.append(total))
    assert totals[10] == pytest.approx(20, abs=3)


def test_an_observer_sees_every_frame_before_it_is_counted(clip: Path) -> None:
    times: list[float] = []
    seen: list[FrameLandmarks] = []
    counted: list[tuple[int, int]] = []

    def observe(frame: VideoFrame, found: FrameLandmarks) -> None:
        times.append(frame.time)
        seen.append(found)

    recording = record(
        clip,
        estimator=ScriptedEstimator(bodiless=frozenset({7})),
        progress=lambda done, _: counted.append((done, len(seen))),
        observer=observe,
    )
    assert times == recording.poses.time.tolist()
    assert all(done == observed for done, observed in counted)
    assert [index for index, found in enumerate(seen) if found.body is None] == [7]
    bodies = [found.body.xy for found in seen if found.body is not None]
    assert np.array_equal(np.stack(bodies), np.delete(recording.poses.xy, 7, axis=0))


def test_recordings_so_far_are_the_first_frames_and_change_nothing(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "long.mp4", frames=200)
    bodiless = frozenset({3, 100})
    whole = record(clip, estimator=ScriptedEstimator(bodiless=bodiless))
    kept: list[Recording] = []
    found = record(clip, estimator=ScriptedEstimator(bodiless=bodiless), keep_so_far=kept.append)
    assert np.array_equal(found.poses.xy, whole.poses.xy, equal_nan=True)
    assert len(kept) >= 2
    ends = [float(each.poses.time[-1]) for each in kept]
    assert ends[0] >= FIRST_SECONDS
    assert (np.diff(ends) >= FIRST_SECONDS).all()
    for each in kept:
        first = whole.poses.xy[: len(each.poses)]
        assert np.array_equal(each.poses.xy, first, equal_nan=True)


def test_an_exception_in_an_observer_cancels(clip: Path) -> None:
    def cancel(frame: VideoFrame, _: FrameLandmarks) -> None:
        raise InterruptedError(f"at {frame.time} s")

    estimator = ScriptedEstimator()
    with pytest.raises(InterruptedError, match=r"at 0\.0 s"):
        record(clip, estimator=estimator, observer=cancel)
    assert len(estimator.times) == 1


def test_an_exception_in_progress_cancels_and_frees_the_clip(clip: Path) -> None:
    class CancelledError(Exception):
        pass

    def cancel_at_five(done: int, _: int) -> None:
        if done == 5:
            raise CancelledError

    estimator = ScriptedEstimator()
    with pytest.raises(CancelledError):
        record(clip, estimator=estimator, progress=cancel_at_five)
    assert len(estimator.times) == 5
    clip.unlink()


def test_an_estimator_used_before_starts_afresh(clip: Path) -> None:
    estimator = ScriptedEstimator()
    first = record(clip, estimator=estimator)
    assert record(clip, estimator=estimator).poses == first.poses


def test_a_damaged_clip_is_recorded_as_far_as_it_goes(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=60, options={"movflags": "faststart"})
    recording = record(cut_off(clip, 0.8), estimator=ScriptedEstimator())
    assert 0 < len(recording.poses) < 60
    assert f"{len(recording.poses)} of 60 frames were read" in recording.warnings[0]


def test_what_is_no_clip_is_refused(tmp_path: Path) -> None:
    (tmp_path / "clip.mp4").write_text("a dive log")
    with pytest.raises(VideoError):
        record(tmp_path / "clip.mp4", estimator=ScriptedEstimator())


@pytest.mark.slow
def test_a_real_diver_is_followed_in_every_frame(shared_data: Path) -> None:
    recording = record(shared_data / "clips" / "diver_follow_me.webm")
    assert len(recording.poses) == 83
    assert recording.poses.duration == pytest.approx(6.0, abs=0.01)
    assert recording.poses.seen.all(axis=1).mean() > 0.9
    assert takes_in(recording) == ()


def test_a_clip_of_a_diver_on_the_side_says_how_to_turn_it(tmp_path: Path) -> None:
    class Lying(ScriptedEstimator):
        def estimate(self, image: Image, time: float) -> FrameLandmarks:
            found = super().estimate(image, time)
            assert found.body is not None
            found.body.xy[[POSE_LANDMARKS.index(f"{side}_hip") for side in ("left", "right")]] = 50
            found.body.xy[[POSE_LANDMARKS.index("left_hip")], 1] = 10
            found.body.xy[[POSE_LANDMARKS.index("right_hip")], 1] = 20
            return found

    clip = write_clip(tmp_path / "clip.mp4")
    (warning, *_) = record(clip, estimator=Lying()).warnings
    assert "the head to the left" in warning
    assert "--turn 90" in warning
