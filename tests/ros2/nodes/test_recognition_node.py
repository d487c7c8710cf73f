"""Keypoints in, recognitions out: those of the recording, with its stamps, take by take."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from keypoints_interfaces.msg import PoseKeypoints, PoseKeypointsArray
from osg_interfaces.msg import (
    ActiveLanguage,
    BodyKeypoints,
    GestureRecognition,
    Hands,
    RecognizerState,
)
from osg_interfaces.srv import ReloadLanguage
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, String
from vision_msgs.msg import Classification

from app.recognition import Gesture, Language, Recognizer, Recording, takes_in
from app.recognition.poses.frame import Body
from osg_ros.nodes.managed_node import ManagedNode
from osg_ros.nodes.recognition_node import RecognitionNode
from osg_ros.topics.body_messages import to_published_keypoints
from osg_ros.topics.stamps import to_nanoseconds, to_stamp
from tests.api.recordings import recording_of
from tests.ros2.nodes.bench import LATCHED, Bench
from tests.ros2.nodes.keypoint_messages import messages_of, stamped


def language_of(*labels: str) -> Language:
    """Return a language whose gestures are shown as the recordings of these tests show them."""
    gestures = [
        Gesture.from_demonstration(label, takes_in(recording_of(label))[0].poses, command=label)
        for label in labels
    ]
    return Language("two signs", gestures)


@pytest.fixture(scope="module")
def two_signs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("languages") / "two-signs.json"
    language_of("circle", "line").save(path)
    return path


@pytest.fixture
def recogniser(bench: Bench, two_signs: Path) -> RecognitionNode:
    node: RecognitionNode = bench.active(RecognitionNode, language=str(two_signs))
    return node


def play(bench: Bench, recording: Recording) -> None:
    """Send a recording, each picture's body and hands, and wait until all was received."""
    bodies = bench.speaker(BodyKeypoints, "body_keypoints")
    hands = bench.speaker(Hands, "hands")
    before = bench.nodes[-1].health.inputs
    for sent, (body, seen) in enumerate(messages_of(recording), 1):
        bodies.publish(body)
        hands.publish(seen)
        wait_for_inputs(bench, bench.nodes[-1], before + sent)


def wait_for_inputs(bench: Bench, node: ManagedNode, messages: int) -> None:
    """Wait until a node has processed some number of messages."""
    bench.wait(lambda: node.health.inputs == messages, f"{messages} messages received")


def test_takes_are_those_of_the_recording_label_by_label_and_stamp_by_stamp(
    bench: Bench, recogniser: RecognitionNode, two_signs: Path
) -> None:
    recording = recording_of("circle", "line", "circle")
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    play(bench, recording)
    bench.wait(lambda: len(recognitions) == 3, "three recognitions")
    language = Language.load(two_signs)
    recognizer = Recognizer(language)
    for message, take in zip(recognitions, takes_in(recording), strict=True):
        answer = recognizer.recognize(take.poses)
        assert (message.label, message.nearest) == (answer.label, answer.nearest)
        assert message.confidence == pytest.approx(answer.confidence, abs=1e-9)
        assert message.margin == pytest.approx(answer.margin, abs=1e-9)
        assert to_nanoseconds(message.start) == stamped(take.start)
        assert to_nanoseconds(message.end) == stamped(take.end)
        assert (message.closed, message.rejected, message.reason) == (True, False, "")
        assert (message.body_id, message.header.frame_id) == ("diver", "camera")
        assert json.loads(message.report)["votes"] == answer.votes
        assert message.language_revision == language.revision
        assert len(message.language_id) == 64
    assert [message.label for message in recognitions] == ["circle", "line", "circle"]


def test_labels_are_sent_as_the_published_port_and_vision_msgs_have_them(
    bench: Bench, recogniser: RecognitionNode
) -> None:
    labels = bench.subscribe(String, "recognized_gesture")
    classes = bench.subscribe(Classification, "classification")
    play(bench, recording_of("line"))
    bench.wait(lambda: bool(labels and classes), "label and class")
    assert [label.data for label in labels] == ["line"]
    assert [result.class_id for result in classes[0].results] == ["line"]
    assert classes[0].results[0].score > 0.5


def test_a_rejected_take_says_why_and_reaches_nobody_who_reads_labels(
    bench: Bench, tmp_path: Path
) -> None:
    path = tmp_path / "one-sign.json"
    language_of("line").save(path)
    bench.active(RecognitionNode, language=str(path))
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    labels = bench.subscribe(String, "recognized_gesture")
    play(bench, recording_of("circle", "line"))
    bench.wait(lambda: len(recognitions) == 2 and bool(labels), "both takes")
    assert recognitions[0].rejected
    assert (recognitions[0].label, recognitions[0].nearest) == ("", "line")
    assert "no gesture of 'two signs'" in recognitions[0].reason
    assert [label.data for label in labels] == ["line"]


def test_states_are_told_with_the_stamp_of_the_picture_that_changed_them(
    bench: Bench, recogniser: RecognitionNode
) -> None:
    states = bench.subscribe(RecognizerState, "state", LATCHED)
    bench.wait(lambda: bool(states), "state of before")
    recording = recording_of("circle")
    play(bench, recording)
    bench.wait(lambda: len(states) == 3, "three states")
    assert [state.state for state in states] == [
        RecognizerState.IDLE,
        RecognizerState.RECORDING,
        RecognizerState.DONE,
    ]
    stamps = {stamped(seconds) for seconds in recording.poses.time.tolist()}
    assert {to_nanoseconds(state.header.stamp) for state in states[1:]} <= stamps


def test_a_stream_that_begins_anew_ends_the_take_that_was_begun(
    bench: Bench, recogniser: RecognitionNode
) -> None:
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    whole = recording_of("circle")
    play(bench, cut(whole, 40))
    play(bench, whole)
    bench.wait(lambda: len(recognitions) == 2, "both takes")
    assert recognitions[0].rejected
    assert "time went back" in recognitions[0].reason
    assert recognitions[1].label == "circle"


@pytest.mark.withstands(row="H27")
def test_keypoints_without_stamps_are_timed_by_their_arrival(bench: Bench, two_signs: Path) -> None:
    node = bench.active(RecognitionNode, language=str(two_signs), use_sim_time=True)
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    clock = bench.speaker(Clock, "/clock")
    bodies, hands = bench.speaker(BodyKeypoints, "body_keypoints"), bench.speaker(Hands, "hands")
    recording = recording_of("circle")
    for seconds, (body, seen) in zip(
        recording.poses.time.tolist(), messages_of(recording), strict=True
    ):
        now = stamped(seconds)
        clock.publish(Clock(clock=to_stamp(now)))
        bench.wait(lambda now=now: node.get_clock().now().nanoseconds == now, "time")  # type: ignore[misc]
        body.header.stamp = seen.header.stamp = to_stamp(0)
        before = node.health.inputs
        bodies.publish(body)
        hands.publish(seen)
        wait_for_inputs(bench, node, before + 1)
    bench.wait(lambda: bool(recognitions), "recognition")
    assert recognitions[0].label == "circle"


def test_a_pause_in_a_take_ends_it_and_not_the_node(
    bench: Bench, recogniser: RecognitionNode
) -> None:
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    play(bench, cut(recording_of("circle"), 40))
    later = recording_of("circle")
    poses = replace(later.poses, time=later.poses.time + 70)
    play(bench, Recording(poses, later.hands, later.salute))
    bench.wait(lambda: len(recognitions) == 2, "both takes")
    assert recognitions[0].rejected
    assert "no salute ended it within 60 s" in recognitions[0].reason
    assert recognitions[1].label == "circle"
    assert recogniser.facts()["late or repeated"] == "0"


def test_the_published_ports_nodes_can_stay(bench: Bench, two_signs: Path) -> None:
    recording = recording_of("line")
    size = recording.poses.frame_size
    # Its messages have no stamps: the node's clock tells how long a gesture took.
    node = bench.active(
        RecognitionNode,
        language=str(two_signs),
        input="published",
        image_width=size[0],
        image_height=size[1],
        use_sim_time=True,
    )
    clock = bench.speaker(Clock, "/clock")
    bodies = bench.speaker(PoseKeypointsArray, "pose_keypoints")
    salutes = bench.speaker(Bool, "vulcan_salute_detected")
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    frames = zip(recording.poses.time.tolist(), recording.poses.xy, recording.salute, strict=True)
    for sent, (seconds, xy, salute) in enumerate(frames):
        now = stamped(seconds)
        clock.publish(Clock(clock=to_stamp(now)))
        bench.wait(lambda now=now: node.get_clock().now().nanoseconds == now, "time")  # type: ignore[misc]
        body = Body(xy, np.ones(len(xy)), 1.0)
        bodies.publish(to_published_keypoints(PoseKeypointsArray, PoseKeypoints, size, body))
        wait_for_inputs(bench, node, 2 * sent + 1)
        salutes.publish(Bool(data=bool(salute > 0.5)))
        wait_for_inputs(bench, node, 2 * sent + 2)
    bench.wait(lambda: bool(recognitions), "recognition")
    assert recognitions[0].label == "line"
    assert to_nanoseconds(recognitions[0].start) == stamped(takes_in(recording)[0].start)


def test_another_language_is_spoken_without_missing_a_picture(
    bench: Bench, recogniser: RecognitionNode, tmp_path: Path
) -> None:
    path = tmp_path / "one-sign.json"
    Language("one sign", language_of("line").gestures).save(path)
    languages = bench.subscribe(ActiveLanguage, "language", LATCHED)
    bench.wait(lambda: bool(languages), "language")
    response = bench.ask(ReloadLanguage, "reload_language", ReloadLanguage.Request(path=str(path)))
    assert response.success
    assert "'one sign', revision 1, with 1 gestures" in response.message
    bench.wait(lambda: len(languages) == 2, "second language")
    assert languages[1].language_id == response.language_id != languages[0].language_id
    assert list(languages[1].labels) == list(languages[1].commands) == ["line"]
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    play(bench, recording_of("line"))
    bench.wait(lambda: bool(recognitions), "recognition")
    assert recognitions[0].language_name == "one sign"


@pytest.mark.withstands(row="H27")
def test_a_language_that_is_refused_leaves_the_old_one(
    bench: Bench, recogniser: RecognitionNode, tmp_path: Path
) -> None:
    path = tmp_path / "broken.json"
    path.write_text("{}", encoding="utf-8")
    request = ReloadLanguage.Request(path=str(path))
    response = bench.ask(ReloadLanguage, "reload_language", request)
    assert not response.success
    assert "is refused, the language stays" in response.message
    assert response.language_revision == 1


def cut(recording: Recording, frames: int) -> Recording:
    """Return the first frames of a recording."""
    end = float(recording.poses.time[frames - 1])
    return Recording(
        poses=recording.poses.between(0.0, end),
        hands=recording.hands[:frames],
        salute=recording.salute[:frames],
        warnings=(),
    )
