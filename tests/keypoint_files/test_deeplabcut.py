"""DeepLabCut's predictions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.keypoint_files import KeypointOptions, read_keypoints
from app.recognition.errors import KeypointFileError
from tests.keypoint_files.files import renamed, write_deeplabcut
from tests.recognition.strategies import BODY, circle, recording

POSES = recording(circle, frames=9, landmarks=tuple(BODY))
AT_25 = KeypointOptions(frame_rate=25)

GOLDEN = """scorer,DLC_resnet50,DLC_resnet50,DLC_resnet50,DLC_resnet50,DLC_resnet50,DLC_resnet50
bodyparts,RWrist,RWrist,RWrist,tail,tail,tail
coords,x,y,likelihood,x,y,likelihood
0,101.5,202.25,0.99,5,6,0.9
1,102.5,203.25,0.98,5,6,0.9
2,400.0,10.0,0.59,5,6,0.9
"""


def test_a_file_of_deeplabcut_itself_is_read(tmp_path: Path) -> None:
    (tmp_path / "dive.csv").write_text(GOLDEN)
    read = read_keypoints(tmp_path / "dive.csv", AT_25)
    poses = read.recording.poses
    assert poses.landmarks == ("right_wrist",)
    assert poses.xy[:2, 0].tolist() == [[101.5, 202.25], [102.5, 203.25]]
    assert poses.time.tolist() == pytest.approx([0, 0.04, 0.08])
    # Below DeepLabCut's own likelihood cutoff: a place far off.
    assert poses.seen[:, 0].tolist() == [True, True, False]
    assert any("tail" in warning for warning in read.recording.warnings)


def test_landmarks_come_back_by_their_names(tmp_path: Path) -> None:
    names = {"right_wrist": "Wrist_R", "left_wrist": "wristL"}
    path = write_deeplabcut(tmp_path / "dive.csv", {"diver": renamed(POSES, names)})
    poses = read_keypoints(path, KeypointOptions(frame_rate=30)).recording.poses
    assert poses.landmarks == POSES.landmarks
    np.testing.assert_allclose(poses.xy, POSES.xy)
    np.testing.assert_allclose(poses.time, POSES.time)


def test_of_several_individuals_the_most_prominent_is_followed(tmp_path: Path) -> None:
    far = replace(POSES, xy=POSES.xy * 0.3)
    path = write_deeplabcut(tmp_path / "dive.csv", {"buddy": far, "diver": POSES})
    read = read_keypoints(path, AT_25)
    np.testing.assert_allclose(read.recording.poses.xy, POSES.xy)
    told = "two people are seen; the body is that of the person who stands out most"
    assert told in read.recording.warnings
    assert read.recording.people is not None
    assert set(read.recording.people.tolist()) == {2}


def test_individuals_that_change_places_are_followed_by_place(tmp_path: Path) -> None:
    far = replace(POSES, xy=POSES.xy * 0.3 + (600, 20))
    late = (np.arange(len(POSES)) >= len(POSES) // 2)[:, None, None]
    people = {
        "diver1": replace(POSES, xy=np.where(late, far.xy, POSES.xy)),
        "diver2": replace(POSES, xy=np.where(late, POSES.xy, far.xy)),
    }
    read = read_keypoints(write_deeplabcut(tmp_path / "dive.csv", people), AT_25)
    np.testing.assert_allclose(read.recording.poses.xy, POSES.xy)


def test_individuals_who_stay_who_they_are_are_not_exchanged(tmp_path: Path) -> None:
    near = replace(POSES, xy=POSES.xy * 0.9 + (15, 10))
    path = write_deeplabcut(tmp_path / "dive.csv", {"buddy": near, "diver": POSES})
    np.testing.assert_allclose(read_keypoints(path, AT_25).recording.poses.xy, POSES.xy)


def test_body_parts_outside_of_the_individuals_are_nobody(tmp_path: Path) -> None:
    """As of a buoy and a ladder, which span more of the picture than the diver."""
    things = renamed(POSES, {name: f"buoy{place}" for place, name in enumerate(POSES.landmarks)})
    single = replace(things, xy=POSES.xy * 3)
    path = write_deeplabcut(tmp_path / "dive.csv", {"diver": POSES, "single": single})
    read = read_keypoints(path, AT_25)
    np.testing.assert_allclose(read.recording.poses.xy, POSES.xy)
    assert not any("individuals" in warning for warning in read.recording.warnings)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("scorer,a\nbodyparts,nose\n", "lacks DeepLabCut's headings"),
        ("scorer,a,a\nbodyparts,nose,nose\ncoords,x,z\n0,1,2\n", "lacks DeepLabCut's headings"),
        ("scorer,a,a\nbodyparts,nose\ncoords,x,y\n0,1,2\n", "lacks DeepLabCut's headings"),
        (
            "scorer,a,a\nindividuals,b\nbodyparts,nose,nose\ncoords,x,y\n0,1,2\n",
            "headings of different lengths",
        ),
        ("scorer,a,a\nbodyparts,nose,nose\ncoords,x,y\n", "no frame"),
        ("scorer,a,a\nbodyparts,nose,nose\ncoords,x,y\n0,1\n", "row 0 has 2 cells, expected 3"),
        (
            "scorer,a,a\nbodyparts,nose,nose\ncoords,x,y\nlabeled-data/img1.png,1,2\n",
            "labelled pictures are no recording",
        ),
        ("scorer,a,a\nbodyparts,nose,nose\ncoords,x,y\n1,1,2\n0,1,2\n", "time does not go on"),
    ],
)
def test_what_is_no_file_of_predictions_is_refused(
    tmp_path: Path, content: str, message: str
) -> None:
    (tmp_path / "dive.csv").write_text(content)
    with pytest.raises(KeypointFileError) as refused:
        read_keypoints(tmp_path / "dive.csv", AT_25)
    assert message in str(refused.value)


def test_without_likelihoods_what_has_a_place_is_seen(tmp_path: Path) -> None:
    (tmp_path / "dive.csv").write_text(
        "\ufeffscorer,a,a\nbodyparts,nose,nose\ncoords,x,y\n0,10,20\n1,,\n", encoding="utf-8"
    )
    poses = read_keypoints(tmp_path / "dive.csv", AT_25).recording.poses
    assert poses.seen.tolist() == [[True], [False]]
