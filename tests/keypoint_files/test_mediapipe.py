"""MediaPipe's landmarks in the forms people write them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.keypoint_files import KeypointOptions, read_keypoints
from app.keypoint_files.registry import keypoint_ending
from app.recognition.errors import KeypointFileError, VideoError
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.skeletons import COCO_17
from app.recognition.recording.video_limits import VideoLimits
from tests.keypoint_files.files import (
    fractions,
    unseen_frames,
    write_hands,
    write_long,
    write_named,
    write_numbered,
    write_rows,
)
from tests.recognition.parametric_hand import hand_xy, salute
from tests.recognition.strategies import circle, recording

POSES = recording(circle, frames=10, jitter=0.05)
OPTIONS = KeypointOptions(frame_rate=30, frame_size=POSES.frame_size)


def same(back: PoseSequence, poses: PoseSequence = POSES) -> None:
    assert back.landmarks == poses.landmarks
    np.testing.assert_allclose(back.xy, poses.xy, atol=1e-6)
    np.testing.assert_allclose(back.time, poses.time, atol=1e-3)


@pytest.mark.parametrize("first", [0, 1])
def test_numbered_columns_are_mediapipe_s_33_counted_from_0_or_1(
    tmp_path: Path, first: int
) -> None:
    read = read_keypoints(write_numbered(tmp_path / "pose.csv", POSES, first), OPTIONS)
    same(read.recording.poses)
    assert read.recording.poses.frame_size == POSES.frame_size
    assert read.recording.poses.confidence is not None
    assert (read.recording.poses.confidence == 0.75).all()
    assert not read.has_hands


def test_named_columns_with_milliseconds_need_no_option(tmp_path: Path) -> None:
    same(read_keypoints(write_named(tmp_path / "pose.csv", POSES)).recording.poses)


def _frames(point: Callable[[str, float, float], Any]) -> list[list[Any]]:
    return [
        [point(name, x, y) for name, (x, y) in zip(POSE_LANDMARKS, moment.tolist(), strict=True)]
        for moment in fractions(POSES)
    ]


OBJECTS = _frames(lambda name, x, y: {"x": x, "y": y, "z": 0.0, "visibility": 0.5})
LISTS = _frames(lambda name, x, y: [x, y, 0.0, 0.5])
NAMED = _frames(lambda name, x, y: {"name": name.upper(), "x": x, "y": y})
KEYED = [
    {name: {"x": x, "y": y} for name, (x, y) in zip(POSE_LANDMARKS, moment.tolist(), strict=True)}
    for moment in fractions(POSES)
]


@pytest.mark.parametrize(
    "content",
    [
        OBJECTS,
        LISTS,
        NAMED,
        [{"landmarks": frame} for frame in OBJECTS],
        [{"pose_landmarks": [frame]} for frame in OBJECTS],
        [{"poseLandmarks": frame} for frame in OBJECTS],
        {"frames": [{"keypoints": frame, "frame": at} for at, frame in enumerate(LISTS)]},
        {"poses": [{"pose": frame} for frame in KEYED]},
    ],
    ids=["objects", "lists", "named", "landmarks", "tasks", "browser", "frames", "keyed"],
)
def test_json_is_read_however_it_is_laid_out(tmp_path: Path, content: object) -> None:
    (tmp_path / "pose.json").write_text(json.dumps(content))
    same(read_keypoints(tmp_path / "pose.json", OPTIONS).recording.poses)


def test_json_may_tell_size_rate_and_time_itself(tmp_path: Path) -> None:
    width, height = POSES.frame_size
    about = {"width": width, "height": height}
    (tmp_path / "rate.json").write_text(json.dumps({**about, "fps": 30, "frames": OBJECTS}))
    same(read_keypoints(tmp_path / "rate.json").recording.poses)
    timed = [
        {"timestamp": time, "landmarks": frame}
        for time, frame in zip(POSES.time.tolist(), OBJECTS, strict=True)
    ]
    (tmp_path / "time.json").write_text(json.dumps({**about, "frames": timed}))
    same(read_keypoints(tmp_path / "time.json").recording.poses)


def test_a_frame_without_anybody_is_a_gap(tmp_path: Path) -> None:
    content: list[Any] = [*OBJECTS[:4], None, [], *OBJECTS[6:]]
    (tmp_path / "pose.json").write_text(json.dumps(content))
    read = read_keypoints(tmp_path / "pose.json", OPTIONS)
    assert unseen_frames(read.recording.poses) == [4, 5]
    assert "no person in 2 of 10 frames" in read.recording.warnings


@pytest.mark.parametrize("cell", ["", "nan", "NaN", "None"])
def test_empty_cells_and_no_visibility_are_not_seen(tmp_path: Path, cell: str) -> None:
    rows: list[list[object]] = [
        ["time", "nose_x", "nose_y", "nose_v", "left_wrist_x", "left_wrist_y"]
    ]
    rows += [[0.0, 10, 20, 0.9, cell, cell], [0.1, 11, 21, 0, 30, 40]]
    poses = read_keypoints(write_rows(tmp_path / "pose.csv", rows)).recording.poses
    assert poses.seen.tolist() == [[True, False], [False, True]]


def test_pixels_need_no_size_and_fractions_do(tmp_path: Path) -> None:
    read = read_keypoints(write_long(tmp_path / "long.csv", POSES), KeypointOptions(frame_rate=30))
    assert read.recording.poses.frame_size >= tuple(POSES.xy.max(axis=(0, 1)).astype(int))
    numbered = write_numbered(tmp_path / "numbered.csv", POSES)
    with pytest.raises(KeypointFileError, match=r"fractions of the picture.*--frame-size"):
        read_keypoints(numbered, KeypointOptions(frame_rate=30))
    with pytest.raises(KeypointFileError, match=r"counts frames.*--frame-rate"):
        read_keypoints(numbered, KeypointOptions(frame_size=POSES.frame_size))


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([], "no columns of keypoints among none"),
        ([["a", "b"], [1, 2]], "no columns of keypoints among a, b"),
        ([["time", "nose_x", "nose_y"]], "no keypoint is seen in any of 0 frames"),
        ([["time", "nose_x", "nose_y"], [0, "left", 2]], "row 0 has 'left' in column 2"),
        (
            [["time", "nose_x", "nose_y"], [2, 20, 30], [1, 21, 30]],
            "time does not go on at frame 2, but begins again, from 2 to 1:",
        ),
        ([["time", "nose_x", "nose_y"], ["", 20, 30]], "time does not go on at frame 1"),
        ([["time", "paw_x", "paw_y"], [0, 20, 30]], "--landmark paw=right_wrist"),
        ([["landmark", "x", "y"], ["nose", 20, 30]], "no column that tells the frame"),
        ([["frame", "landmark", "x", "y"]], "no keypoint is seen in any of 0 frames"),
        (
            [["frame", "landmark", "x", "y"], [0, "nose", 20, 30], [0, "nose", 21, 31]],
            "row 1 is the second for nose",
        ),
    ],
)
def test_a_table_that_cannot_be_read_is_told_where(
    tmp_path: Path, rows: list[list[object]], message: str
) -> None:
    path = write_rows(tmp_path / "pose.csv", rows)
    with pytest.raises(KeypointFileError) as refused:
        read_keypoints(path, KeypointOptions(frame_rate=30))
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "content",
    [
        '{"frames": [{"time": 0, "landmarks": [[1, 2]]}, {"landmarks": [[1, 2]]}]}',
        '{"frames": [[[1, 2]]], "fps": "fast"}',
        '{"frames": [[[1, 2]]], "fps": -30}',
        '{"frames": [[[1, 2]]], "width": 0, "height": 9}',
        "[[[1" + "0" * 400 + ", 2]]]",
        "",
        "7",
        "{}",
        '{"frames": 3}',
        "[[1, 2]]",
        '[[{"x": "a", "y": 1}]]',
        "[[[[[]]]]]",
        '{"images": [{}], "annotations": [{"image_id": 1, "keypoints": [1, 2, 1]}]}',
        '{"images": 3, "annotations": [{"image_id": 1, "keypoints": [1, 2, 1]}]}',
        '[{"image_id": 1, "keypoints": [1, 2]}]',
        '[{"instances": 3}]',
        '[{"instances": [{"keypoints": [[1, 2]], "keypoint_scores": [1, 1]}]}]',
        '{"meta_info": {"keypoint_id2name": {"a": 1}}, "frames": [[[1, 2]]]}',
        "[" * 100_000,
    ],
)
def test_json_that_cannot_be_read_is_one_line(tmp_path: Path, content: str) -> None:
    (tmp_path / "pose.json").write_text(content)
    with pytest.raises(KeypointFileError) as refused:
        read_keypoints(tmp_path / "pose.json", OPTIONS)
    assert "\n" not in str(refused.value)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    (tmp_path / "pose.csv").write_bytes(b"\xff\xfe\x00nose_x,nose_y\n1,2\n")
    with pytest.raises(KeypointFileError, match="is no text table"):
        read_keypoints(tmp_path / "pose.csv", OPTIONS)


def test_names_with_both_sides_of_the_map_are_told(tmp_path: Path) -> None:
    rows: list[list[object]] = [["time", "paw_x", "paw_y", "tail_x", "tail_y"]]
    rows += [[0.1 * step, 10 + step, 20, 30, 40] for step in range(3)]
    path = write_rows(tmp_path / "pose.csv", rows)
    read = read_keypoints(path, KeypointOptions(landmarks={"paw": "right_wrist"}))
    assert read.recording.poses.landmarks == ("right_wrist",)
    assert any("left out" in warning and "tail" in warning for warning in read.recording.warnings)
    assert any("gives no nose, left_shoulder" in told for told in read.recording.warnings)
    both = KeypointOptions(landmarks={"paw": "right_wrist", "tail": "claw"})
    assert read_keypoints(path, both).recording.poses.landmarks == ("right_wrist", "claw")
    twice = KeypointOptions(landmarks={"paw": "right_wrist", "tail": "right_wrist"})
    with pytest.raises(KeypointFileError, match="'paw' and 'tail' are both 'right_wrist'"):
        read_keypoints(path, twice)
    with pytest.raises(KeypointFileError, match="no keypoint 'fin'; it has paw, tail"):
        read_keypoints(path, KeypointOptions(landmarks={"fin": "right_wrist"}))


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), float("inf")])
def test_a_rate_or_size_that_cannot_be_is_refused(rate: float) -> None:
    with pytest.raises(KeypointFileError, match="frame rate is"):
        KeypointOptions(frame_rate=rate)
    with pytest.raises(KeypointFileError, match="frame size is"):
        KeypointOptions(frame_size=(0, 10))
    with pytest.raises(KeypointFileError, match="is 1x65535, and a width of 1 shows no person"):
        KeypointOptions(frame_size=(1, 65535))


def test_a_real_file_of_mediapipe_is_read(shared_data: Path) -> None:
    path = shared_data / "clips" / "image_pose_d-D_person205_front.csv"
    read = read_keypoints(path, KeypointOptions(frame_rate=30, frame_size=(1080, 1920)))
    poses = read.recording.poses
    assert poses.landmarks == POSE_LANDMARKS
    assert poses.seen.all()
    assert poses.column("nose")[:, 1].mean() < poses.column("left_hip")[:, 1].mean()
    assert replace(poses).torso_length() is not None


def test_landmarks_around_zero_are_in_no_picture(tmp_path: Path) -> None:
    world = replace(POSES, xy=(POSES.xy - POSES.xy.mean(axis=(0, 1))) / 240)
    path = write_long(tmp_path / "world.csv", world)
    with pytest.raises(KeypointFileError, match="not MediaPipe's world landmarks"):
        read_keypoints(path, OPTIONS)


def test_too_long_a_recording_is_refused_by_its_limit(tmp_path: Path) -> None:
    few = VideoLimits(frames=5)
    (tmp_path / "pose.json").write_text(json.dumps(OBJECTS))
    for path in (
        tmp_path / "pose.json",
        write_long(tmp_path / "long.csv", POSES),
        write_numbered(tmp_path / "numbered.csv", POSES),
    ):
        with pytest.raises(VideoError, match="more than the limit of 5"):
            read_keypoints(path, OPTIONS, few)


def rewritten(source: Path, separator: str, *, encoding: str = "utf-8") -> Path:
    """Write a table as Excel does in many countries: other separators, and a decimal comma."""
    rows = [line.split(",") for line in source.read_text().splitlines()]
    cells = [[cell.replace(".", ",") if separator == ";" else cell for cell in row] for row in rows]
    source.write_text("\n".join(separator.join(row) for row in cells), encoding=encoding)
    return source


@pytest.mark.parametrize(
    ("separator", "encoding"),
    [(",", "utf-8"), (";", "utf-8"), ("\t", "utf-16"), (",", "utf-8-sig"), (";", "utf-16")],
)
@pytest.mark.parametrize("write", [write_named, write_long])
def test_tables_by_excel_are_read_with_their_separators_and_encodings(
    tmp_path: Path, write: Callable[[Path, PoseSequence], Path], separator: str, encoding: str
) -> None:
    path = rewritten(write(tmp_path / "pose.csv", POSES), separator, encoding=encoding)
    assert keypoint_ending(path.read_bytes()[:4096], path.name) == ".csv"
    same(read_keypoints(path, OPTIONS).recording.poses)


@pytest.mark.parametrize(
    ("heading", "scale", "since"),
    [
        ("timestamp", 1, 1.7e9),
        ("timestamp", 1e3, 0),
        ("timestamp_us", 1e6, 0),
        ("timestamp", 1e6, 0),
        ("timestamp", 1e9, 1_700_000_000_000_000_000),
        ("time_ns", 1e9, 0),
    ],
)
def test_times_are_read_in_seconds_milli_micro_and_nanoseconds(
    tmp_path: Path, heading: str, scale: float, since: float
) -> None:
    rows: list[list[object]] = [[heading, "nose_x", "nose_y"]]
    rows += [[int(since) + round(at / 30 * scale, 6), 10 + at, 20] for at in range(10)]
    poses = read_keypoints(write_rows(tmp_path / "pose.csv", rows)).recording.poses
    np.testing.assert_allclose(poses.time, np.arange(10) / 30, atol=2e-4)


def test_a_keypoint_at_0_0_is_not_seen(tmp_path: Path) -> None:
    rows: list[list[object]] = [["time", "nose_x", "nose_y"], [0.0, 10, 20], [0.1, 0, 0.0]]
    rows += [[0.2, 0, 20]]
    poses = read_keypoints(write_rows(tmp_path / "pose.csv", rows)).recording.poses
    assert poses.seen[:, 0].tolist() == [True, False, True]


@pytest.mark.parametrize("others", [42, 468, 510, 478 + 42])
def test_numbered_tables_of_body_hands_and_face_give_the_body(tmp_path: Path, others: int) -> None:
    source = write_numbered(tmp_path / "pose.csv", POSES, 1)
    lines = source.read_text().splitlines()
    extra = [f"{axis}{34 + place}" for place in range(others) for axis in "xy"]
    values = ["0.5"] * len(extra)
    wide = [",".join([line, *(values if row else extra)]) for row, line in enumerate(lines)]
    source.write_text("\n".join(wide))
    read = read_keypoints(source, OPTIONS).recording
    same(read.poses)
    assert any("and " in note and "more; keep one" in note for note in read.warnings)


def person(points: FloatArray, *, flat: bool, score: float = 0.9) -> dict[str, Any]:
    """Return one person of MMPose (nested), or of COCO's results (flat)."""
    if flat:
        return {"keypoints": [value for x, y in points.tolist() for value in (x, y, score)]}
    return {"keypoints": points.tolist(), "keypoint_scores": [score] * len(points)}


COCO_COLUMNS = [POSE_LANDMARKS.index(name) for name in COCO_17]


@pytest.mark.parametrize("count", [17, 133])
@pytest.mark.parametrize("kind", ["mmpose", "mmpose_demo", "coco", "alphapose"])
def test_results_of_mmpose_alphapose_and_coco_are_read_and_one_person_is_followed(
    tmp_path: Path, kind: str, count: int
) -> None:
    body = POSES.xy[:, COCO_COLUMNS]
    whole = np.concatenate([body, np.repeat(body[:, :1], count - 17, axis=1)], axis=1)
    for first, side in ((91, "left"), (112, "right")):
        whole[:, first : first + 21] = POSES.column(f"{side}_wrist")[:, None]
    small = 5 + whole / 10
    flat = kind in ("coco", "alphapose")
    frames = [[person(each[at], flat=flat) for each in (small, whole)] for at in range(len(whole))]
    content: Any
    if flat:
        name = "{:06d}.jpg" if kind == "alphapose" else "{}"
        content = [
            {"image_id": name.format(at), "score": 1.0, **one}
            for at, people in enumerate(frames)
            for one in people
        ]
    else:
        content = [{"frame_id": at, "instances": people} for at, people in enumerate(frames)]
        content = {"instance_info": content} if kind == "mmpose_demo" else content
    (tmp_path / "pose.json").write_text(json.dumps(content))
    poses = read_keypoints(tmp_path / "pose.json", OPTIONS).recording.poses
    assert poses.landmarks == COCO_17
    np.testing.assert_allclose(poses.xy, body, atol=1e-6)


def test_who_stands_out_most_is_chosen_though_somebody_small_comes_first(tmp_path: Path) -> None:
    body = POSES.xy[:, COCO_COLUMNS]
    late = len(body) // 3
    shown = [
        (5 + each / 10, each) if at >= late else (5 + each / 10,) for at, each in enumerate(body)
    ]
    content = [{"instances": [person(one, flat=False) for one in people]} for people in shown]
    (tmp_path / "pose.json").write_text(json.dumps(content))
    recording = read_keypoints(tmp_path / "pose.json", OPTIONS).recording
    assert not recording.poses.seen[:late].any()
    np.testing.assert_allclose(recording.poses.xy[late:], body[late:], atol=1e-6)
    assert any("two people are seen" in warning for warning in recording.warnings)


@pytest.mark.parametrize("named", ["left_hand_{}_{}", "LH_{}.{}", "{1}_hand_left_{0}"])
def test_hands_of_a_table_are_read_and_show_a_salute(tmp_path: Path, named: str) -> None:
    path = write_hands(tmp_path / "pose.csv", POSES, hand_xy(salute()), named)
    read = read_keypoints(path, OPTIONS)
    same(read.recording.poses)
    assert read.has_hands
    assert [len(hands) for hands in read.recording.hands] == [1] * 3 + [0] * (len(POSES) - 3)
    assert read.recording.hands[0][0].side == "left"
    assert (read.recording.salute > 0.5).tolist() == [True] * 3 + [False] * (len(POSES) - 3)
    assert not any("left out" in warning for warning in read.recording.warnings)


def test_columns_of_hands_that_are_never_seen_change_nothing(tmp_path: Path) -> None:
    heads = [f"pose_{number}_{axis}" for number in range(33) for axis in "xy"]
    heads += [
        f"{side}_hand_{n}_{axis}" for side in ("left", "right") for n in range(21) for axis in "xy"
    ]
    rows = [[*moment.ravel().tolist(), *[""] * 84] for moment in fractions(POSES)]
    read = read_keypoints(write_rows(tmp_path / "pose.csv", [heads, *rows]), OPTIONS)
    same(read.recording.poses)
    assert not read.has_hands
    assert not any("left out" in warning for warning in read.recording.warnings)


@pytest.mark.parametrize("key", ["rightHandLandmarks", "right_hand_landmarks"])
def test_hands_in_json_are_read_and_show_a_salute(tmp_path: Path, key: str) -> None:
    hand = hand_xy(salute()) / np.array(POSES.frame_size)
    fingers = [{"x": x, "y": y, "z": 0.0} for x, y in hand.tolist()]
    content: list[dict[str, Any]] = [
        {"poseLandmarks": frame, key: fingers if index < 3 else None}
        for index, frame in enumerate(OBJECTS)
    ]
    (tmp_path / "pose.json").write_text(json.dumps(content))
    read = read_keypoints(tmp_path / "pose.json", OPTIONS)
    same(read.recording.poses)
    assert [len(hands) for hands in read.recording.hands] == [1] * 3 + [0] * (len(POSES) - 3)
    assert read.recording.hands[0][0].side == "right"
    assert (read.recording.salute > 0.5).tolist() == [True] * 3 + [False] * (len(POSES) - 3)
    content[0][key] = fingers[:20]
    (tmp_path / "pose.json").write_text(json.dumps(content))
    assert not read_keypoints(tmp_path / "pose.json", OPTIONS).recording.hands[0]
