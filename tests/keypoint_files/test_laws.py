"""Laws of all readers: what is dropped, shifted, repeated, widened or permuted is told."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.keypoint_files import KeypointOptions, ReadKeypoints, read_keypoints
from app.recognition import Language, Recognizer, Recording
from app.recognition.errors import KeypointFileError
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import BODY_25, COCO_17, LandmarkSet
from app.recognition.recording.clip_range import find_clip_range
from tests.conftest import RECORDINGS
from tests.keypoint_files.files import write_rows

LINE = Recording.load(RECORDINGS / "avx2" / "line-test-2.npz").poses
OPTIONS = KeypointOptions(frame_size=LINE.frame_size)
STROKE = (2.3, 3.65)
NAMED = [f"{name}_{axis}" for name in POSE_LANDMARKS for axis in "xy"]
LAYOUTS = ["csv", "tsv", "json"]

several = settings(
    max_examples=10, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    return Recognizer(Language.load("languages/osg-table-2.json"))


def write(folder: Path, layout: str, time: Sequence[float], xy: FloatArray) -> Path:
    """Write MediaPipe's landmarks with times, in a table or as JSON."""
    if layout == "json":
        frames = [
            {"time": moment, "landmarks": [{"x": x, "y": y} for x, y in each]}
            for moment, each in zip(time, xy.tolist(), strict=True)
        ]
        path = folder / "pose.json"
        path.write_text(json.dumps(frames))
        return path
    rows = [[moment, *each.ravel().tolist()] for moment, each in zip(time, xy, strict=True)]
    path = write_rows(folder / "pose.csv", [["time", *NAMED], *rows])
    if layout == "tsv":
        path = path.rename(path.with_suffix(".tsv"))
        path.write_text(path.read_text().replace(",", "\t"))
    return path


def label_in(recognizer: Recognizer, read: ReadKeypoints, start: float, end: float) -> str | None:
    found = find_clip_range(read.recording, start, end)
    return recognizer.recognize(found.poses, found.unseen).label


@pytest.mark.parametrize("layout", LAYOUTS)
@several
@given(st.floats(1.0, 40.0), st.floats(-1e6, 1e9))
def test_dropped_frames_are_told_and_nothing_is_read_across_them(
    tmp_path: Path, recognizer: Recognizer, layout: str, hole: float, since: float
) -> None:
    middle = sum(STROKE) / 2
    time = since + LINE.time + np.where(LINE.time > middle, hole, 0.0)
    read = read_keypoints(write(tmp_path, layout, time.tolist(), LINE.xy), OPTIONS)
    words = "no gesture is read across it" if hole > 3 else "no frame from"
    assert any(words in told for told in read.recording.warnings)
    assert label_in(recognizer, read, STROKE[0], STROKE[1] + hole) is None


@pytest.mark.parametrize("layout", LAYOUTS)
@several
@given(st.integers(20, 100), st.sampled_from([-1e4, -60.0, -2.0, 61.0, 3600.0, 1.7e9]))
def test_a_shifted_clock_is_told_by_its_own_sentence(
    tmp_path: Path, layout: str, at: int, shift: float
) -> None:
    time = LINE.time + np.where(np.arange(len(LINE)) > at, shift, 0.0)
    path = write(tmp_path, layout, time.tolist(), LINE.xy)
    try:
        told = " ".join(read_keypoints(path, OPTIONS).recording.warnings)
    except KeypointFileError as error:
        told = str(error)
    assert "begins again" in told or f"ahead by {shift:.0f} s" in told
    assert "sort" not in told
    assert "hold" not in told


@pytest.mark.parametrize("layout", LAYOUTS)
@several
@given(st.sampled_from(["each", "some", "rounded"]), st.integers(1, 90))
def test_repeated_rows_and_rounded_times_are_never_to_be_sorted(
    tmp_path: Path, layout: str, kind: str, at: int
) -> None:
    rows = np.arange(len(LINE))
    time = np.round(LINE.time) if kind == "rounded" else LINE.time
    if kind != "rounded":
        rows = np.sort(np.concatenate([rows, rows if kind == "each" else rows[at : at + 3]]))
    path = write(tmp_path, layout, time[rows].tolist(), LINE.xy[rows])
    words = "times are rounded" if kind == "rounded" else "rows stand twice"
    with pytest.raises(KeypointFileError, match=words):
        read_keypoints(path, OPTIONS)


@pytest.mark.parametrize("layout", ["csv", "tsv"])
@several
@given(st.integers(0, 80), st.integers(1, 70))
def test_rows_wider_than_the_heading_are_refused(
    tmp_path: Path, layout: str, at: int, more: int
) -> None:
    path = write(tmp_path, layout, LINE.time.tolist(), LINE.xy)
    lines = path.read_text().splitlines()
    lines[1 + at] += ("," if layout == "csv" else "\t") + ("," if layout == "csv" else "\t").join(
        ["1"] * more
    )
    path.write_text("\n".join(lines))
    with pytest.raises(KeypointFileError, match=f"have {67 + more} cells, the heading 67"):
        read_keypoints(path, OPTIONS)


@pytest.mark.parametrize("at", [1, 5, 40])
def test_a_column_that_stands_twice_is_refused(tmp_path: Path, at: int) -> None:
    rows = [[moment, *each.ravel()] for moment, each in zip(LINE.time, LINE.xy, strict=True)]
    heads = ["time", *NAMED]
    path = write_rows(tmp_path / "pose.csv", [[*heads, heads[at]], *([*row, 7] for row in rows)])
    with pytest.raises(KeypointFileError, match=f"{heads[at]!r} stands twice"):
        read_keypoints(path, OPTIONS)


def places(landmarks: LandmarkSet) -> FloatArray:
    """Return LINE's places in the order of a set, with neck and middle of the hips."""
    pairs = {1: ("left_shoulder", "right_shoulder"), 8: ("left_hip", "right_hip")}
    return np.stack(
        [
            np.mean([LINE.column(each) for each in pairs.get(at, pairs[8])], axis=0)
            if name is None
            else LINE.column(name)
            for at, name in enumerate(landmarks)
        ],
        axis=1,
    )


def numbered(folder: Path, points: FloatArray, layout: str) -> Path:
    heads = [f"{axis}{place}" for place in range(points.shape[1]) for axis in "xy"]
    if layout == "csv":
        rows: list[Any] = [heads, *(each.ravel().tolist() for each in points)]
        return write_rows(folder / "pose.csv", rows)
    path = folder / "pose.json"
    path.write_text(json.dumps(points.tolist()))
    return path


@pytest.mark.parametrize("layout", ["csv", "json"])
@several
@given(
    st.sampled_from([BODY_25, POSE_LANDMARKS[:25], POSE_LANDMARKS]).flatmap(
        lambda landmarks: st.tuples(st.just(landmarks), st.permutations(range(len(landmarks))))
    )
)
def test_numbers_are_of_a_set_only_where_their_places_agree(
    tmp_path: Path, layout: str, drawn: tuple[LandmarkSet, list[int]]
) -> None:
    landmarks, order = drawn
    points = places(landmarks)
    options = KeypointOptions(frame_rate=25, frame_size=LINE.frame_size)
    read = read_keypoints(numbered(tmp_path, points, layout), options)
    np.testing.assert_allclose(
        read.recording.poses.column("right_wrist"), LINE.column("right_wrist")
    )
    try:
        other = read_keypoints(numbered(tmp_path, points[:, order], layout), options)
    except KeypointFileError as error:
        assert "do not lie as those of" in str(error)  # noqa: PT017
    else:  # so near that nobody can tell: the head and the shoulders are where they were
        assert other.recording.poses.landmarks == read.recording.poses.landmarks


def test_the_user_s_word_decides(tmp_path: Path) -> None:
    points = places(BODY_25)[:, ::-1]
    path = numbered(tmp_path, points, "csv")
    options = KeypointOptions(25, LINE.frame_size, keypoint_set="BODY_25")
    assert "right_wrist" in read_keypoints(path, options).recording.poses.landmarks
    wrong = KeypointOptions(25, LINE.frame_size, keypoint_set="coco")
    with pytest.raises(KeypointFileError, match="no set of 25 keypoints is called 'coco'"):
        read_keypoints(path, wrong)


def test_names_from_the_viewer_s_side_are_told(tmp_path: Path) -> None:
    swapped = [name.translate(str.maketrans("", "")) for name in POSE_LANDMARKS]
    order = [
        POSE_LANDMARKS.index(
            name.replace("left", "*").replace("right", "left").replace("*", "right")
        )
        for name in swapped
    ]
    read = read_keypoints(write(tmp_path, "csv", LINE.time.tolist(), LINE.xy[:, order]), OPTIONS)
    assert any("viewer's side" in told for told in read.recording.warnings)
    plain = read_keypoints(write(tmp_path, "csv", LINE.time.tolist(), LINE.xy), OPTIONS)
    assert not any("viewer's side" in told for told in plain.recording.warnings)


@pytest.mark.parametrize("layout", ["posenet", "ml5", "ultralytics"])
def test_layouts_of_neighbours_are_read(tmp_path: Path, layout: str) -> None:
    points = [LINE.column(name).tolist() for name in COCO_17]
    frames: list[Any] = []
    for row in zip(*points, strict=True):
        parts = [
            {"part": name, "score": 0.9, "position": {"x": x, "y": y}}
            for name, (x, y) in zip(COCO_17, row, strict=True)
        ]
        xs, ys = map(list, zip(*row, strict=True))
        frames.append(
            {
                "posenet": {"score": 0.9, "keypoints": parts},
                "ml5": [{"pose": {"score": 0.9, "keypoints": parts}, "skeleton": []}],
                "ultralytics": [{"name": "person", "keypoints": {"x": xs, "y": ys}}],
            }[layout]
        )
    path = tmp_path / "pose.json"
    path.write_text(json.dumps(frames))
    read = read_keypoints(path, KeypointOptions(25, LINE.frame_size))
    wrist = read.recording.poses.column("right_wrist")
    np.testing.assert_allclose(wrist, LINE.column("right_wrist"))


def test_the_line_of_a_spreadsheet_that_names_the_separator_is_no_heading(tmp_path: Path) -> None:
    path = write(tmp_path, "csv", LINE.time.tolist(), LINE.xy)
    path.write_text("sep=,\n" + path.read_text())
    assert len(read_keypoints(path, OPTIONS).recording.poses) == len(LINE)
