"""Keypoints without names: their set is known, or they are refused; never guessed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.keypoint_files import KeypointOptions, ReadKeypoints, read_keypoints
from app.recognition.errors import KeypointFileError
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import (
    BODY_25,
    COCO_17,
    CROWDPOSE_14,
    H36M_17,
    HALPE_26,
    KEYPOINT_SETS,
    LandmarkSet,
)
from app.recognition.recording.salute import ENTER_SCORE
from app.recognition.recording.timestamps import SEAM
from tests.keypoint_files.files import write_rows
from tests.recognition.parametric_hand import hand_xy, salute
from tests.recognition.strategies import circle, recording

POSES = recording(circle, frames=10)
OPTIONS = KeypointOptions(frame_rate=25, frame_size=POSES.frame_size)
LEGS = {"knee": (0.0, 120.0), "ankle": (0.0, 240.0), "foot_index": (0.0, 260.0)}
WHOLE = {133: (*COCO_17, *(None,) * 116), 136: (*HALPE_26, *(None,) * 110)}
LEFT_HAND = {133: 91, 136: 94}


def points_of(landmarks: LandmarkSet) -> FloatArray:
    """Return ``(T, N, 2)`` pixels of a set; legs hang down, the head is where the nose is."""
    columns = []
    middles = [each.middles for each in KEYPOINT_SETS if each.landmarks == landmarks]
    neck = middles[0][0] if middles and middles[0] else None
    for at, name in enumerate(landmarks):
        side, _, part = (name or "").partition("_")
        if part in LEGS:
            column = POSES.column(f"{side}_hip") + LEGS[part]
        elif name is None:
            joint = "shoulder" if at == neck else "hip"
            column = np.mean(
                [POSES.column(f"{each}_{joint}") for each in ("left", "right")], axis=0
            )
        else:
            column = POSES.column("nose" if part in ("eye", "ear") else name)
        columns.append(column)
    points = np.stack(columns, axis=1)
    first = LEFT_HAND.get(len(landmarks), len(landmarks))
    for side, at in (("left", first), ("right", first + len(HAND_LANDMARKS))):
        points[:, at : at + len(HAND_LANDMARKS)] = POSES.column(f"{side}_wrist")[:, None]
    return points


def write_json(folder: Path, content: Any) -> Path:
    path = folder / "pose.json"
    path.write_text(json.dumps(content))
    return path


def alphapose(folder: Path, points: FloatArray, **about: Any) -> Path:
    people = [
        {"image_id": f"{at}.jpg", "keypoints": np.insert(each, 2, 0.9, axis=1).ravel().tolist()}
        for at, each in enumerate(points)
    ]
    return write_json(folder, {**about, "annotations": people} if about else people)


def mmpose(folder: Path, points: FloatArray, **about: Any) -> Path:
    frames = [
        {"frame_id": at, "instances": [{"keypoints": each, "keypoint_scores": [0.9] * len(each)}]}
        for at, each in enumerate(points.tolist(), 1)
    ]
    return write_json(folder, {**about, "instance_info": frames})


def lists(folder: Path, points: FloatArray) -> Path:
    return write_json(folder, points.tolist())


def pose2sim(folder: Path, points: FloatArray) -> Path:
    for at, each in enumerate(points):
        person = {"pose_keypoints_2d": np.insert(each, 2, 0.9, axis=1).ravel().tolist()}
        (folder / f"dive_{at:06d}.json").write_text(json.dumps({"people": [person]}))
    return folder


def wide(folder: Path, points: FloatArray) -> Path:
    heads = [f"{axis}{place}" for place in range(points.shape[1]) for axis in "xy"]
    return write_rows(folder / "pose.csv", [heads, *(each.ravel().tolist() for each in points)])


def long(folder: Path, points: FloatArray) -> Path:
    rows = [
        [at, place, *point]
        for at, each in enumerate(points.tolist())
        for place, point in enumerate(each)
    ]
    return write_rows(folder / "pose.csv", [["frame", "landmark", "x", "y"], *rows])


WRITERS = [alphapose, mmpose, lists, pose2sim, wide, long]


def wrists_of(read: ReadKeypoints) -> FloatArray:
    poses = read.recording.poses
    return np.stack([poses.column("left_wrist"), poses.column("right_wrist")])


RIGHT = np.stack([POSES.column("left_wrist"), POSES.column("right_wrist")])


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize(
    "landmarks",
    [COCO_17, BODY_25, HALPE_26, *WHOLE.values()],
    ids=["COCO", "BODY_25", "Halpe 26", "COCO-WholeBody", "Halpe 136"],
)
def test_a_well_known_set_is_read_by_its_count_in_every_layout(
    tmp_path: Path, write: Any, landmarks: LandmarkSet
) -> None:
    read = read_keypoints(write(tmp_path, points_of(landmarks)), OPTIONS)
    np.testing.assert_allclose(wrists_of(read), RIGHT)


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize(
    "landmarks", [CROWDPOSE_14, H36M_17, (*COCO_17[5:], *COCO_17[:4]), (*HALPE_26, *COCO_17)]
)
def test_a_count_of_more_than_one_meaning_is_refused_and_never_guessed(
    tmp_path: Path, write: Any, landmarks: LandmarkSet
) -> None:
    with pytest.raises(KeypointFileError, match=f"has {len(landmarks)} keypoints without names"):
        read_keypoints(write(tmp_path, points_of(landmarks)), OPTIONS)


H36M_NAMES = {place: name or f"other_{place}" for place, name in enumerate(H36M_17)}


@pytest.mark.parametrize(
    ("landmarks", "about"),
    [
        (H36M_17, {"meta_info": {"dataset_name": "Human3.6M"}}),
        (H36M_17, {"meta": {"dataset_name": "h36m"}}),
        (H36M_17, {"meta_info": {"keypoint_id2name": H36M_NAMES}}),
        (H36M_17, {"categories": [{"keypoints": [*H36M_NAMES.values()]}]}),
        (CROWDPOSE_14, {"meta_info": {"dataset_name": "crowdpose"}}),
        (HALPE_26, {"meta_info": {"dataset_name": "x"}}),
        (HALPE_26, {"meta": "of a dive", "categories": [{"name": "person"}], "images": None}),
    ],
)
@pytest.mark.parametrize("write", [alphapose, mmpose])
def test_a_set_is_known_by_its_name_or_the_names_in_it(
    tmp_path: Path, write: Any, landmarks: LandmarkSet, about: dict[str, Any]
) -> None:
    read = read_keypoints(write(tmp_path, points_of(landmarks), **about), OPTIONS)
    np.testing.assert_allclose(wrists_of(read), RIGHT)


@pytest.mark.parametrize("write", WRITERS)
def test_numbers_may_be_named_by_the_user(tmp_path: Path, write: Any) -> None:
    named = {"13": "left_wrist", "16": "right_wrist"}
    options = KeypointOptions(25, POSES.frame_size, named)
    read = read_keypoints(write(tmp_path, points_of(H36M_17)), options)
    np.testing.assert_allclose(wrists_of(read), RIGHT)


def test_names_that_are_more_or_fewer_than_keypoints_are_refused(tmp_path: Path) -> None:
    path = mmpose(tmp_path, points_of(HALPE_26), categories=[{"keypoints": ["nose", "tail"]}])
    with pytest.raises(KeypointFileError, match="names 2 keypoints and has 26"):
        read_keypoints(path, OPTIONS)


def test_frames_of_several_models_are_refused(tmp_path: Path) -> None:
    frames = [points_of(each)[0].tolist() for each in (COCO_17, HALPE_26)]
    with pytest.raises(KeypointFileError, match="mixes people of 17 and 26 keypoints"):
        read_keypoints(write_json(tmp_path, frames), OPTIONS)


def test_places_in_space_are_no_picture_s(tmp_path: Path) -> None:
    deep = np.insert(points_of(HALPE_26), 2, 1800, axis=2)
    kinect = [{"bodies": [{"joint_positions": each}]} for each in deep.tolist()]
    for path in (
        mmpose(tmp_path, deep),
        write_json(tmp_path, {"joint_names": ["PELVIS"], "frames": kinect}),
        write_json(tmp_path, [{"pose_world_landmarks": each} for each in deep.tolist()]),
    ):
        with pytest.raises(KeypointFileError, match="3D and not of a picture"):
            read_keypoints(path, OPTIONS)


HAND = hand_xy(salute()) * 80
SHOWN = HAND - HAND[0] + POSES.column("left_wrist")[0]
SALUTES = [True] * 3 + [False] * 7


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize("count", WHOLE)
def test_hands_of_a_whole_body_are_kept_and_show_a_salute(
    tmp_path: Path, write: Any, count: int
) -> None:
    points = points_of(WHOLE[count])
    hands = slice(LEFT_HAND[count], LEFT_HAND[count] + len(HAND_LANDMARKS))
    points[:3, hands] = SHOWN
    read = read_keypoints(write(tmp_path, points), OPTIONS)
    assert read.has_hands
    assert (read.recording.salute > ENTER_SCORE).tolist() == SALUTES
    assert read.recording.hands[0][0].side == "left"
    assert not any("left out" in note for note in read.recording.warnings)


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize("count", WHOLE)
def test_hands_that_begin_at_the_other_wrist_are_of_another_set(
    tmp_path: Path, write: Any, count: int
) -> None:
    points = points_of(WHOLE[count])
    first, size = LEFT_HAND[count], len(HAND_LANDMARKS)
    points[:, first : first + 2 * size] = np.roll(points[:, first : first + 2 * size], size, axis=1)
    with pytest.raises(KeypointFileError, match="they do not lie as those of"):
        read_keypoints(write(tmp_path, points), OPTIONS)


def test_hands_that_the_model_of_a_whole_body_only_supposes_are_none(tmp_path: Path) -> None:
    points = points_of(WHOLE[133])
    points[:3, LEFT_HAND[133] : LEFT_HAND[133] + len(HAND_LANDMARKS)] = SHOWN
    path = alphapose(tmp_path, points)
    people = json.loads(path.read_text())
    for person in people:
        person["keypoints"][3 * LEFT_HAND[133] + 2 :: 3] = [0.1] * (133 - LEFT_HAND[133])
    read = read_keypoints(write_json(tmp_path, people), OPTIONS)
    assert not read.recording.salute.any()


def test_hands_beside_the_body_are_kept_and_show_a_salute(tmp_path: Path) -> None:
    points = points_of(COCO_17).tolist()
    tasks = [
        {"keypoints": each, "left_hand_landmarks": [SHOWN.tolist()] if seen else []}
        for each, seen in zip(points, SALUTES, strict=True)
    ]
    scored = np.insert(SHOWN, 2, 2, axis=1).ravel().tolist()
    coco = [
        {"image_id": at, "keypoints": each, "lefthand_kpts": scored if seen else [0] * 63}
        for at, (each, seen) in enumerate(zip(points, SALUTES, strict=True))
    ]
    for content in (tasks, coco):
        read = read_keypoints(write_json(tmp_path, content), OPTIONS)
        assert (read.recording.salute > ENTER_SCORE).tolist() == SALUTES
        assert read.recording.hands[0][0].side == "left"
    (tmp_path / "pose.json").unlink()
    for file, seen in zip(
        sorted(pose2sim(tmp_path, points_of(BODY_25)).iterdir()), SALUTES, strict=True
    ):
        content = json.loads(file.read_text())
        content["people"][0]["hand_left_keypoints"] = scored if seen else []
        file.write_text(json.dumps(content))
    read = read_keypoints(tmp_path, OPTIONS)
    assert (read.recording.salute > ENTER_SCORE).tolist() == SALUTES


BODIES = [
    {"keypoints": np.insert(each, 2, 0.9, axis=1).ravel().tolist()} for each in points_of(COCO_17)
]


def test_images_without_people_and_out_of_order_keep_their_time(tmp_path: Path) -> None:
    numbers = [0, 1, 2, 3, 4, 15, 16, 17, 18, 19]
    shuffled = np.random.default_rng(0).permutation(10).tolist()
    people = [{"image_id": f"{numbers[at]}.jpg", **BODIES[at]} for at in shuffled]
    read = read_keypoints(write_json(tmp_path, people), OPTIONS).recording
    np.testing.assert_allclose(read.poses.time, np.arange(20) / 25)
    np.testing.assert_allclose(read.poses.column("right_wrist")[numbers], RIGHT[1])
    assert "no person in 10 of 20 frames" in read.warnings


def test_images_before_anybody_comes_count(tmp_path: Path) -> None:
    people = [{"image_id": f"frame_{50 + at:05d}.png", **BODIES[at]} for at in range(10)]
    poses = read_keypoints(write_json(tmp_path, people), OPTIONS).recording.poses
    assert poses.time[-1] == pytest.approx(59 / 25)
    cut = [{"image_id": 7_000_000 + 5 * at, **BODIES[at]} for at in range(10)]
    poses = read_keypoints(write_json(tmp_path, cut), OPTIONS).recording.poses
    np.testing.assert_allclose(poses.time, np.arange(10) / 5)


def test_images_of_a_list_tell_frames_and_size(tmp_path: Path) -> None:
    images = [
        {"id": 900 - at, "file_name": f"a/{at:06d}.jpg", "width": 640, "height": 480}
        for at in range(12)
    ]
    people = [{"image_id": 900 - at - 2, **BODIES[at]} for at in range(10)]
    content = {"images": images, "annotations": people}
    poses = read_keypoints(write_json(tmp_path, content), KeypointOptions(25)).recording.poses
    assert poses.frame_size == (640, 480)
    assert len(poses) == 12
    np.testing.assert_allclose(poses.column("right_wrist")[2:], RIGHT[1])


def test_frames_of_mmpose_are_ordered_by_their_number(tmp_path: Path) -> None:
    path = mmpose(tmp_path, points_of(COCO_17))
    content = json.loads(path.read_text())
    content["instance_info"].reverse()
    del content["instance_info"][4:6]
    poses = read_keypoints(write_json(tmp_path, content), OPTIONS).recording.poses
    np.testing.assert_allclose(poses.time, np.array([0, 1, 2, 3, 6, 7, 8, 9]) / 25)
    np.testing.assert_allclose(poses.column("right_wrist")[0], RIGHT[1][0])


@pytest.mark.parametrize("names", [["reef", "wreck"], ["a/1.jpg", "b/1.jpg"]])
def test_images_that_tell_no_order_are_refused(tmp_path: Path, names: list[str]) -> None:
    people = [{"image_id": name, **BODIES[0]} for name in names]
    with pytest.raises(KeypointFileError, match="tell no order of time; number them by frame"):
        read_keypoints(write_json(tmp_path, people), OPTIONS)


@pytest.mark.parametrize("place", [(-1, -1), (-999, -999), (9999, 9999), (20, 65535)])
@pytest.mark.parametrize("size", [POSES.frame_size, None])
@pytest.mark.parametrize("write", [alphapose, wide])
def test_not_found_is_not_a_place(
    tmp_path: Path, write: Any, place: tuple[int, int], size: tuple[int, int] | None
) -> None:
    points = points_of(COCO_17)
    points[3:7, COCO_17.index("right_wrist")] = place
    poses = read_keypoints(write(tmp_path, points), KeypointOptions(25, size)).recording.poses
    seen = np.isfinite(poses.column("right_wrist")[:, 0])
    assert seen.tolist() == [True] * 3 + [False] * 4 + [True] * 3
    assert max(poses.frame_size) < 1000


def test_a_body_upside_down_in_every_frame_is_told(tmp_path: Path) -> None:
    points = points_of(COCO_17)
    told = "if y points upwards in this file, write the picture's height minus y"
    read = read_keypoints(wide(tmp_path, points), OPTIONS)
    assert not any(told in note for note in read.recording.warnings)
    points[..., 1] = 480 - points[..., 1]
    read = read_keypoints(wide(tmp_path, points), OPTIONS)
    assert any(told in note for note in read.recording.warnings)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.99])
def test_json_of_a_stopped_program_breaks_off_at_its_last_byte(
    tmp_path: Path, share: float
) -> None:
    path = lists(tmp_path, points_of(COCO_17))
    content = path.read_bytes()[: int(path.stat().st_size * share)]
    path.write_bytes(content)
    with pytest.raises(KeypointFileError, match=f"breaks off at byte {len(content)}"):
        read_keypoints(path, OPTIONS)


def test_json_with_one_document_a_line_and_other_faults_are_named(tmp_path: Path) -> None:
    path = tmp_path / "pose.json"
    for content, words in (
        ("[1]\n[2]\n", "one document a line at line 2"),
        ('[{"x" 1}]', "not JSON"),
    ):
        path.write_text(content)
        with pytest.raises(KeypointFileError, match=words):
            read_keypoints(path, OPTIONS)


def test_a_table_of_tabs_and_quoted_names_after_spaces_are_read(tmp_path: Path) -> None:
    rows = [[at / 25, *each.ravel().tolist()] for at, each in enumerate(points_of(COCO_17))]
    heads = ["time", *(f'"{name}_{axis}"' for name in COCO_17 for axis in "xy")]
    for name, separator in (("pose.tsv", "\t"), ("pose.csv", ", ")):
        path = tmp_path / name
        path.write_text("\n".join(separator.join(map(str, row)) for row in [heads, *rows]))
        np.testing.assert_allclose(wrists_of(read_keypoints(path, OPTIONS)), RIGHT)


@pytest.mark.parametrize("since", [0, 1.7e9])
def test_a_clock_that_is_set_while_keypoints_are_written_is_told(
    tmp_path: Path, since: float
) -> None:
    points = points_of(COCO_17)
    times = [since + at / 25 + (3600 if at > 4 else 0) for at in range(len(points))]
    heads = ["time", *(f"{name}_{axis}" for name in COCO_17 for axis in "xy")]
    rows = [[time, *each.ravel().tolist()] for time, each in zip(times, points, strict=True)]
    read = read_keypoints(write_rows(tmp_path / "pose.csv", [heads, *rows]), OPTIONS)
    expected = np.arange(10) / 25 + (np.arange(10) > 4) * (SEAM - 1 / 25)
    np.testing.assert_allclose(read.recording.poses.time, expected, atol=1e-5)
    assert any("ahead by 3600 s" in told for told in read.recording.warnings)


def test_people_in_lists_without_keys_are_followed(tmp_path: Path) -> None:
    points = points_of(COCO_17)
    people = [[{"keypoints": (each / 5).tolist()}, {"keypoints": each.tolist()}] for each in points]
    read = read_keypoints(write_json(tmp_path, people), OPTIONS)
    np.testing.assert_allclose(wrists_of(read), RIGHT)
