"""OpenPose's folders: a known recording in, the same landmarks out."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.keypoint_files import KeypointOptions, is_keypoint_file, read_keypoints
from app.recognition.errors import KeypointFileError
from app.recognition.poses.frame import Hand
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.skeletons import BODY_25, COCO_18, LandmarkSet
from app.recognition.recording.salute import ENTER_SCORE
from tests.keypoint_files.files import unseen_frames, write_openpose
from tests.recognition.parametric_hand import hand_xy, salute
from tests.recognition.strategies import circle, recording

AT_30 = KeypointOptions(frame_rate=30)

GOLDEN = """{"version":1.3,"people":[{"person_id":[-1],"pose_keypoints_2d":[
 412.5,101.25,0.91, 410,170,0.88, 360,172,0.84, 340,240,0.8, 331.5,300.75,0.77,
 460,168,0.83, 470,235,0.79, 0,0,0],
 "face_keypoints_2d":[],"hand_left_keypoints_2d":[],"hand_right_keypoints_2d":[]}]}"""


def known(landmarks: LandmarkSet, frames: int = 12) -> PoseSequence:
    names = tuple(name for name in landmarks if name is not None)
    return recording(circle, frames=frames, landmarks=names, jitter=0.05)


@pytest.mark.parametrize("landmarks", [BODY_25, COCO_18], ids=["BODY_25", "COCO_18"])
def test_landmarks_come_back_by_their_names(tmp_path: Path, landmarks: LandmarkSet) -> None:
    poses = known(landmarks)
    read = read_keypoints(write_openpose(tmp_path / "json", poses, landmarks), AT_30)
    back = read.recording.poses
    assert back.landmarks == poses.landmarks
    np.testing.assert_allclose(back.xy, poses.xy)
    np.testing.assert_allclose(back.time, poses.time)
    assert back.confidence is not None
    assert (back.confidence == 0.875).all()
    (told,) = read.recording.warnings
    assert told.startswith("the folder gives no left_pinky, right_pinky, left_index")
    assert not read.has_hands


def test_a_file_of_openpose_itself_is_read(tmp_path: Path) -> None:
    content = json.loads(GOLDEN)
    person = content["people"][0]
    person["pose_keypoints_2d"] += [0.0] * (75 - len(person["pose_keypoints_2d"]))
    for number in (4, 6):
        (tmp_path / f"dive_{number:012d}_keypoints.json").write_text(json.dumps(content))
    poses = read_keypoints(tmp_path, KeypointOptions(frame_rate=10)).recording.poses
    assert poses.time.tolist() == pytest.approx([0.0, 0.2])
    assert poses.column("right_wrist")[0].tolist() == [331.5, 300.75]
    assert poses.column("left_elbow")[0].tolist() == [470, 235]
    assert np.isnan(poses.column("left_wrist")).all()
    assert poses.frame_size == (470, 301)


def test_neck_middle_of_the_hips_and_small_toes_are_left_out(tmp_path: Path) -> None:
    read = read_keypoints(write_openpose(tmp_path / "json", known(BODY_25)), AT_30)
    assert len(read.recording.poses.landmarks) == 25 - 4
    assert "neck" not in read.recording.poses.landmarks


def test_frames_are_sorted_by_their_numbers_and_gaps_stay(tmp_path: Path) -> None:
    poses = known(COCO_18)
    folder = write_openpose(tmp_path / "json", poses, COCO_18, first=7)
    (folder / "dive_000000000010_keypoints.json").rename(folder / "dive_100_keypoints.json")
    back = read_keypoints(folder, AT_30).recording.poses
    assert back.time[-1] == pytest.approx((100 - 7) / 30)
    np.testing.assert_allclose(back.xy[-1], poses.xy[3])


def test_hands_are_read_and_salute(tmp_path: Path) -> None:
    poses = known(BODY_25)
    shown = hand_xy(salute()) * 80 + (300, 200)
    hands = [[Hand(shown, "right", 0.9)] if index < 5 else [] for index in range(len(poses))]
    read = read_keypoints(write_openpose(tmp_path / "json", poses, hands=hands), AT_30)
    assert read.has_hands
    assert [len(frame) for frame in read.recording.hands] == [1] * 5 + [0] * 7
    assert read.recording.hands[0][0].side == "right"
    assert ((read.recording.salute > ENTER_SCORE) == (np.arange(12) < 5)).all()


def test_a_frame_without_anybody_is_a_gap_and_counted(tmp_path: Path) -> None:
    poses = known(BODY_25)
    xy = poses.xy.copy()
    xy[3:5] = np.nan
    read = read_keypoints(write_openpose(tmp_path / "json", replace(poses, xy=xy)), AT_30)
    assert unseen_frames(read.recording.poses) == [3, 4]
    assert "no person in 2 of 12 frames" in read.recording.warnings


def test_of_several_people_the_largest_is_followed(tmp_path: Path) -> None:
    poses = known(BODY_25)
    far = replace(poses, xy=poses.xy * 0.4 + (900, 100))
    folder = write_openpose(tmp_path / "json", poses, others=[far])
    read = read_keypoints(folder, AT_30)
    np.testing.assert_allclose(read.recording.poses.xy, poses.xy)
    assert "two people are seen; the body is that of the person who stands out most" in (
        read.recording.warnings
    )
    assert read.recording.people is not None
    assert set(read.recording.people.tolist()) == {2}


def test_fractions_need_the_picture_s_size(tmp_path: Path) -> None:
    poses = known(BODY_25)
    small = replace(poses, xy=poses.xy / (640, 480))
    folder = write_openpose(tmp_path / "json", small)
    with pytest.raises(KeypointFileError, match=r"--frame-size 1920x1080"):
        read_keypoints(folder, AT_30)
    read = read_keypoints(folder, KeypointOptions(frame_rate=30, frame_size=(640, 480)))
    np.testing.assert_allclose(read.recording.poses.xy, poses.xy)


def test_without_a_frame_rate_it_is_asked_for(tmp_path: Path) -> None:
    with pytest.raises(KeypointFileError, match=r"give the video's frame rate.*--frame-rate 30"):
        read_keypoints(write_openpose(tmp_path / "json", known(BODY_25)))


def test_a_folder_is_openpose_s_when_it_holds_its_files(tmp_path: Path) -> None:
    assert not is_keypoint_file(tmp_path)
    assert is_keypoint_file(write_openpose(tmp_path / "json", known(BODY_25)))
    with pytest.raises(KeypointFileError, match=r"holds no \*_keypoints\.json"):
        read_keypoints(tmp_path, AT_30)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is no frame of OpenPose"),
        ("[]", "is no frame of OpenPose"),
        ("{}", '"people"'),
        ('{"people": 3}', "is no frame of OpenPose"),
        ('{"people": [{"pose_keypoints_2d": [1, 2]}]}', "x, y, confidence in a row"),
        ('{"people": [{"pose_keypoints_2d": ["a", 2, 3]}]}', "is no frame of OpenPose"),
        ('{"people": [{"pose_keypoints_2d": [1, 2, 0.5]}]}', "has 1 keypoints without names"),
        ('{"people": []}', "nobody is seen in any of 1 frames"),
        ('{"people": [{"pose_keypoints_2d": []}]}', "a person of 0 keypoints"),
        ("[" * 100_000, "is no frame of OpenPose"),
    ],
)
def test_what_is_no_frame_is_refused_with_its_file(
    tmp_path: Path, content: str, message: str
) -> None:
    (tmp_path / "dive_000000000000_keypoints.json").write_text(content)
    with pytest.raises(KeypointFileError) as refused:
        read_keypoints(tmp_path, AT_30)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_two_clips_in_one_folder_and_mixed_models_are_refused(tmp_path: Path) -> None:
    folder = write_openpose(tmp_path / "json", known(BODY_25))
    (folder / "reef_000000000003_keypoints.json").write_text('{"people": []}')
    with pytest.raises(KeypointFileError, match=r"frame 3 twice, .*keep one clip in a folder"):
        read_keypoints(folder, AT_30)
    mixed = write_openpose(tmp_path / "mixed", known(BODY_25))
    write_openpose(mixed, known(COCO_18), COCO_18, first=50)
    with pytest.raises(KeypointFileError, match="mixes people of 18 and 25 keypoints"):
        read_keypoints(mixed, AT_30)
    (tmp_path / "odd").mkdir()
    (tmp_path / "odd" / "last_keypoints.json").write_text('{"people": []}')
    with pytest.raises(KeypointFileError, match="has no frame number"):
        read_keypoints(tmp_path / "odd", AT_30)
