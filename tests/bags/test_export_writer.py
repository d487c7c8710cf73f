"""A session's MCAP, read back by the plain reader: every message keeps to the schema beside it."""

from __future__ import annotations

import base64
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest
from mcap.writer import Writer

from app.bags.export_writer import CHANNELS, NamedRecognition, write_bag
from app.bags.extraction import record_bag
from app.bags.topic_summary import usable_topics
from app.evaluation.labelled_takes import collect_takes, labelled_files
from app.recognition import Gesture, Language, Recognizer, Recording, takes_in
from app.recognition.errors import BagError, VideoError
from tests.api.recordings import recording_of
from tests.bags.exports import checked
from tests.posed import BY_BELLY, posed_recording
from tests.recognition.damaged_clips import write_clip

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def recording() -> Recording:
    return recording_of("circle", "line")


@pytest.fixture(scope="module")
def recognitions(recording: Recording) -> list[NamedRecognition]:
    """Return what was recognised in both takes by a language of a circle."""
    takes = takes_in(recording)
    language = Language(name="one", gestures=[Gesture.from_demonstration("circle", takes[0].poses)])
    recognizer = Recognizer(language)
    return [
        NamedRecognition(
            take.start, take.end, "one", 3, recognizer.recognize(take.poses), expected="circle"
        )
        for take in takes
    ]


def test_everything_of_the_session_is_in_it_at_its_time(
    tmp_path: Path, recording: Recording, recognitions: list[NamedRecognition]
) -> None:
    video = write_clip(
        tmp_path / "clip.mp4",
        frames=len(recording.poses),
        size=(640, 480),
        times=recording.poses.time.tolist(),
    )
    path = tmp_path / "session.mcap"
    write_bag(path, recording, recognitions, video=video, name="dive.mp4")
    found = checked(path)
    assert set(found) == set(CHANNELS) - {"/log"}
    nanoseconds = [round(time * 1e9) for time in recording.poses.time]
    for topic in ("/video", "/pose", "/keypoints", "/salute"):
        assert [time for time, _ in found[topic]] == nanoseconds

    body = {point["name"]: point for point in found["/keypoints"][30][1]["body"]}
    wrist = recording.poses.column("right_wrist")[30]
    assert (body["right_wrist"]["x"], body["right_wrist"]["y"]) == pytest.approx(wrist, abs=0.01)
    assert "left_thumb" not in body
    assert [content["score"] for _, content in found["/salute"]] == recording.salute.tolist()
    states = [content["state"] for _, content in found["/salute"]]
    assert set(states) == {"idle", "recording", "done"}

    takes = takes_in(recording)
    ranges = [(content["start"], content["end"]) for _, content in found["/takes"]]
    assert ranges == [(take.start, take.end) for take in takes]
    results = [content for _, content in found["/recognitions"]]
    assert [(each["nearest"], each["expected"]) for each in results] == [("circle", "circle")] * 2
    assert [each["rejected"] for each in results] == [
        one.result.label is None for one in recognitions
    ]
    assert results[0]["label"] == "circle"
    assert len(results[0]["votes"]) == len(recognitions[0].result.votes)
    # The label is shown from the end of its take to the beginning of the next one.
    texts = [[text["text"] for text in content["texts"]] for _, content in found["/label"]]
    assert [bool(shown) for shown in texts] == [False, True, False, True]
    assert texts[1][0].startswith("circle  ")


def test_a_pair_is_a_question_and_no_rejection(
    tmp_path: Path, recording: Recording, recognitions: list[NamedRecognition]
) -> None:
    result = recognitions[0].result.model_copy(update={"label": None, "pair": ("circle", "ring")})
    path = tmp_path / "session.mcap"
    write_bag(path, recording, [replace(recognitions[0], result=result)])
    found = checked(path)
    ((_, content),) = found["/recognitions"]
    assert (content["label"], content["pair"], content["rejected"]) == (
        "",
        ["circle", "ring"],
        False,
    )
    assert found["/label"][-1][1]["texts"][0]["text"].startswith("circle or ring?  ")


def test_the_video_is_a_stream_of_single_frames_that_any_decoder_reads(
    tmp_path: Path, recording: Recording
) -> None:
    video = write_clip(tmp_path / "clip.mp4", frames=60, size=(66, 50), codec="mpeg4")
    path = tmp_path / "session.mcap"
    write_bag(path, recording, video=video)
    messages = checked(path)["/video"]
    codec = av.CodecContext.create("h264", "r")
    assert isinstance(codec, av.VideoCodecContext)
    decoded = 0
    for _, content in messages:
        assert content["format"] == "h264"
        data = base64.b64decode(content["data"])
        assert data.startswith((b"\0\0\0\1", b"\0\0\1"))
        decoded += len(codec.decode(av.Packet(data)))
    decoded += len(codec.decode(None))
    assert decoded == len(messages) == 60
    # A player that jumps to the second key frame can begin there.
    second = base64.b64decode(messages[50][1]["data"])
    units = {unit[0] & 31 for unit in second.split(b"\0\0\1")[1:]}
    assert {7, 8} <= units


def test_warnings_are_logged_and_nobody_in_view_is_told(tmp_path: Path) -> None:
    recording = recording_of("line")
    xy = np.full_like(recording.poses.xy, np.nan)
    empty = replace(
        recording, poses=replace(recording.poses, xy=xy), warnings=("no person in any frame",)
    )
    path = tmp_path / "session.mcap"
    done: list[tuple[int, int]] = []
    write_bag(path, empty, progress=lambda *steps: done.append(steps))
    found = checked(path)
    ((time, log),) = found["/log"]
    assert (time, log["message"], log["level"]) == (0, "no person in any frame", 3)
    assert all(content["body"] == [] for _, content in found["/keypoints"])
    assert all(drawn["points"] == [] for _, each in found["/pose"] for drawn in each["points"])
    assert done[-1] == (len(xy), len(xy))


def test_without_what_writes_mcap_the_command_to_install_it_is_told(
    tmp_path: Path, recording: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(BagError, match="pip install"):
        write_bag(tmp_path / "session.mcap", recording)
    assert not (tmp_path / "session.mcap").exists()


def test_takes_lie_between_the_triggers_of_the_language(tmp_path: Path) -> None:
    file = tmp_path / "session.mcap"
    write_bag(file, posed_recording("circle-by-belly"), trigger=BY_BELLY)
    found = checked(file)
    (take,) = takes_in(posed_recording("circle-by-belly"), trigger=BY_BELLY)
    assert [content["start"] for _, content in found["/takes"]] == pytest.approx([take.start])
    assert max(content["score"] for _, content in found["/salute"]) > 0.9


def test_the_keypoints_of_a_session_are_read_back(
    tmp_path: Path, sample_recording: Callable[[str], Recording]
) -> None:
    written = sample_recording("line-test-1")
    path = tmp_path / "line.mcap"
    write_bag(path, written, name="dive.mp4")
    (topic,) = usable_topics(path)
    poses = written.poses
    assert (topic.use, topic.messages) == ("keypoints", len(poses))
    assert topic.duration == pytest.approx(poses.duration)
    assert (topic.width, topic.height) == poses.frame_size
    read = record_bag(path)
    np.testing.assert_allclose(read.poses.time, poses.time, atol=1e-6)
    np.testing.assert_allclose(read.poses.xy, poses.xy, atol=0.006)
    assert [len(hands) for hands in read.hands] == [len(hands) for hands in written.hands]
    np.testing.assert_allclose(read.salute, written.salute, atol=0.01)
    (take,) = collect_takes(labelled_files(tmp_path)).takes
    (original,) = takes_in(written)
    assert take.label == "line"
    assert len(take.poses) == len(original.poses)


@pytest.mark.parametrize("seed", range(12))
def test_flipped_bytes_of_a_session_give_frames_or_one_line(
    tmp_path: Path, recording: Recording, seed: int
) -> None:
    path = tmp_path / "session.mcap"
    write_bag(path, recording)
    random, content = np.random.default_rng(seed), bytearray(path.read_bytes())
    for place in random.integers(64, len(content), 1 + seed * 3):
        content[place] = random.integers(0, 256)
    path.write_bytes(content)
    said, frames = "", 1
    try:
        frames = len(record_bag(path).poses)
    except (BagError, VideoError) as error:
        said = str(error)
    assert 0 < frames <= len(recording.poses)
    assert "\n" not in said


def test_a_session_cut_short_or_without_keypoints_is_refused_in_one_line(
    tmp_path: Path, recording: Recording
) -> None:
    path = tmp_path / "session.mcap"
    write_bag(path, recording)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(BagError, match=r"session\.mcap is damaged or cut short"):
        record_bag(path)
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(library="osg-studio 0.2.0")
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(BagError, match="have no messages"):
        record_bag(path)
