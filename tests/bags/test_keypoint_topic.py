"""Topics of recorded keypoints: the same gestures without a model."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.bags.bag import open_bag
from app.bags.extraction import record_bag
from app.bags.keypoint_topic import ASSUMED_SIZE
from app.recognition import Gesture, Language, Recognizer, Recording, takes_in
from app.recognition.errors import BagError
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.recording.extraction import Observer
from app.recognition.recording.video import probe, read_frames
from tests.api.recordings import recording_of
from tests.bags.bag_files import (
    Row,
    Storage,
    message,
    our_rows,
    published_rows,
    skeleton_rows,
    write_bag,
)


@pytest.fixture(scope="module")
def language() -> Language:
    """Return a language of three shapes."""
    gestures = [
        Gesture.from_demonstration(shape, takes_in(recording_of(shape))[0].poses)
        for shape in ("circle", "circle backwards", "line")
    ]
    return Language(name="shapes", gestures=gestures)


def labelled(recording: Recording, language: Language) -> list[tuple[float, float, str | None]]:
    """Return start, end (to a millisecond) and label of each take."""
    recognizer = Recognizer(language)
    return [
        (round(take.start, 3), round(take.end, 3), recognizer.recognize(take.poses).label)
        for take in takes_in(recording)
    ]


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("rows", [published_rows, our_rows])
def test_recorded_keypoints_come_out_as_the_gestures_that_went_in(
    tmp_path: Path, language: Language, storage: Storage, rows: object
) -> None:
    recording = recording_of("circle", "line", "circle backwards")
    assert callable(rows)
    read = record_bag(write_bag(tmp_path / "dive", rows(recording), storage))
    assert labelled(read, language) == labelled(recording, language)
    assert [label for *_, label in labelled(read, language)] == [
        "circle",
        "line",
        "circle backwards",
    ]
    assert np.allclose(read.poses.time, recording.poses.time, atol=1e-9)
    assert np.allclose(read.poses.xy, recording.poses.xy, atol=0.001, equal_nan=True)
    assert read.poses.frame_size == recording.poses.frame_size
    assert np.array_equal(read.salute > 0.5, recording.salute > 0.5)


def test_a_skeleton_of_ros4hri_fills_the_landmarks_that_it_has(tmp_path: Path) -> None:
    recording = recording_of("line")
    with_size = list(skeleton_rows(recording))
    read = record_bag(write_bag(tmp_path / "dive", with_size))
    width, height = ASSUMED_SIZE
    scale = np.array([width / 640, height / 480])
    wrist = POSE_LANDMARKS.index("right_wrist")
    assert np.allclose(read.poses.xy[:, wrist], recording.poses.xy[:, wrist] * scale, atol=0.01)
    assert np.isnan(read.poses.xy[:, POSE_LANDMARKS.index("left_thumb")]).all()
    assert read.poses.frame_size == ASSUMED_SIZE
    warnings = " ".join(read.list_warnings())
    assert "1280 x 720 is taken" in warnings
    assert "skeleton2d has no left_pinky" in warnings
    assert "no topic of the salute" in warnings


def test_the_clip_is_shown_as_a_skeleton_at_its_own_times(tmp_path: Path) -> None:
    recording = recording_of("line")
    bag = write_bag(tmp_path / "dive", published_rows(recording))
    shown: list[float] = []
    observer: Observer = lambda frame, found: shown.append(frame.time)  # noqa: E731
    read = record_bag(bag, video=tmp_path / "video", observer=observer)
    assert "there is no picture: the skeleton is drawn" in read.warnings[0]
    assert shown == read.poses.time.tolist()
    assert (probe(tmp_path / "video").width, probe(tmp_path / "video").height) == (640, 480)
    frames = list(read_frames(tmp_path / "video"))
    assert np.allclose([frame.time for frame in frames], read.poses.time, atol=1e-6)
    x, y = (round(value) for value in read.poses.column("right_shoulder")[0])
    image = frames[0].image
    assert image[y, x].max() > 100
    assert image[5, 5].max() < 30


def test_time_is_when_messages_were_received_where_they_have_no_stamp(tmp_path: Path) -> None:
    read = record_bag(write_bag(tmp_path / "dive", published_rows(recording_of("line"))))
    assert any("say not when the picture was taken" in warning for warning in read.warnings)
    ours = record_bag(write_bag(tmp_path / "ours", our_rows(recording_of("line"))))
    assert not any("say not when" in warning for warning in ours.warnings)


def test_nobody_unknown_names_and_numbers_out_of_all_bounds_are_landmarks_not_seen(
    tmp_path: Path,
) -> None:
    def spoiled() -> Iterator[Row]:
        for index, (topic, content, received) in enumerate(published_rows(recording_of("line"))):
            if topic == "/pose_keypoints":
                content.keypoints[0].name = "THIRD_ARM"
                content.keypoints[15].x = float("inf")
                content.keypoints[16].x = 1e30
                content.keypoints[13].x = content.keypoints[13].y = -1.0
                if index == 0:
                    content.keypoints = []
            yield topic, content, received

    read = record_bag(write_bag(tmp_path / "dive", spoiled()), video=tmp_path / "video")
    assert np.isnan(read.poses.column("left_wrist")).all()
    assert np.isnan(read.poses.column("right_wrist")).all()
    assert np.isnan(read.poses.column("left_elbow")).all()
    warnings = " ".join(read.warnings)
    assert "no person in 1 of" in warnings
    assert "/pose_keypoints has no nose" in warnings


def test_a_topic_that_names_no_landmark_of_a_body_is_refused(tmp_path: Path) -> None:
    kind = "keypoints_interfaces/msg/PoseKeypoints"
    points = [message(kind, "THUMB_TIP", 0.5, 0.5)]
    content = message("keypoints_interfaces/msg/PoseKeypointsArray", points)
    with pytest.raises(BagError, match="names a landmark that is known here"):
        record_bag(write_bag(tmp_path / "dive", [("/hand_keypoints", content, 10**18)]))


def test_a_salute_that_is_no_longer_told_is_over(tmp_path: Path) -> None:
    recording = recording_of("line")

    def died() -> Iterator[Row]:
        flags = 0
        for topic, content, received in published_rows(recording):
            flags += topic == "/vulcan_salute_detected"
            if topic != "/vulcan_salute_detected" or flags <= 8:
                yield topic, content, received

    read = record_bag(write_bag(tmp_path / "dive", died()))
    assert read.salute[:8].all()
    assert not read.salute[20:].any()


def test_the_salute_in_the_same_namespace_is_taken(tmp_path: Path) -> None:
    recording = recording_of("line")

    def two_divers() -> Iterator[Row]:
        for topic, content, received in published_rows(recording):
            yield f"/buddy{topic}", content, received
            if topic == "/vulcan_salute_detected":
                yield f"/another{topic}", message("std_msgs/msg/Bool", True), received

    bag_path = write_bag(tmp_path / "dive", two_divers())
    with open_bag(bag_path) as bag:
        assert bag.topic().name == "/buddy/pose_keypoints"
    read = record_bag(bag_path)
    assert np.array_equal(read.salute > 0.5, recording.salute > 0.5)
