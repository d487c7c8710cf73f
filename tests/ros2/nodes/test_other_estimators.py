"""The gesture node with another pose estimator, without hands, and so without salutes."""

from __future__ import annotations

from pathlib import Path

import pytest
from osg_interfaces.msg import GestureRecognition, Hands
from osg_interfaces.srv import ReloadLanguage
from rclpy.lifecycle import TransitionCallbackReturn
from sensor_msgs.msg import Image

from app.recognition import Gesture, Language
from app.recognition.recording.video import read_frames
from osg_ros.nodes.gesture_node import GestureNode
from osg_ros.topics.image_messages import to_image_message
from osg_ros.topics.stamps import to_nanoseconds, to_stamp
from tests.marker_clips import marker_clip
from tests.recognition.demonstrations import pool
from tests.recognition.estimation.marker_models import save_yolo_pose
from tests.recognition.strategies import circle, line, recording
from tests.ros2.nodes.bench import BEST_EFFORT, Bench
from tests.ros2.nodes.keypoint_messages import stamped

WITHOUT_HANDS = {"hands": "none", "without_salutes": True}


@pytest.fixture(scope="module")
def estimator(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the parameter that names a model that finds markers."""
    path = tmp_path_factory.mktemp("model") / "markers-pose.onnx"
    return f"yolo-pose:{save_yolo_pose(path, side=320)}"


@pytest.fixture
def two_signs(tmp_path: Path) -> str:
    pool(circle=circle, line=line).save(tmp_path / "pool.json")
    return str(tmp_path / "pool.json")


@pytest.fixture
def pointing(tmp_path: Path) -> str:
    """Return a language that follows a finger, which the model does not find."""
    poses = recording(circle, hand="right_index")
    gesture = Gesture.from_demonstration("pointed", poses, salient=["right_index"])
    Language("fingers", [gesture]).save(tmp_path / "fingers.json")
    return str(tmp_path / "fingers.json")


@pytest.mark.slow
def test_a_gesture_without_salutes_is_heard_by_yolo_pose(
    bench: Bench, tmp_path: Path, estimator: str, two_signs: str
) -> None:
    parameters = {
        **WITHOUT_HANDS,
        "estimator": estimator,
        "water": "off",  # correcting the colours would repaint the markers
        "qos_overrides./image.subscription.reliability": "reliable",
    }
    node = bench.active(GestureNode, language=two_signs, **parameters)
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    seen = bench.subscribe(Hands, "hands", BEST_EFFORT)
    pictures = bench.speaker(Image, "image")
    with read_frames(marker_clip(tmp_path / "line.mkv", line)) as frames:
        for count, frame in enumerate(frames, 1):
            message = to_image_message(frame.image)
            message.header.stamp = to_stamp(stamped(frame.time))
            pictures.publish(message)
            bench.wait(lambda count=count: node.health.inputs == count, "picture")  # type: ignore[misc]
            last = frame.time
    bench.wait(lambda: bool(seen), "hands")
    # Results that are pending when the pictures end are published then.
    assert node.trigger_deactivate() == TransitionCallbackReturn.SUCCESS
    bench.wait(lambda: bool(recognitions), "recognition")
    (take,) = recognitions
    assert (take.label, take.rejected) == ("line", False)
    assert stamped(0) <= to_nanoseconds(take.start) < to_nanoseconds(take.end) <= stamped(last)
    assert not any(hands.hands for hands in seen)


def test_without_hands_salutes_are_not_waited_for(
    bench: Bench, estimator: str, two_signs: str
) -> None:
    node = bench.add(GestureNode, language=two_signs, estimator=estimator, hands="none")
    assert node.trigger_configure() == TransitionCallbackReturn.FAILURE
    (status,) = node.health.report(0.0, 1.0, {}).status
    assert "without hands no salute is seen" in status.message


def test_a_language_that_needs_what_the_model_does_not_find_is_refused(
    bench: Bench, estimator: str, two_signs: str, pointing: str
) -> None:
    node = bench.active(GestureNode, language=two_signs, estimator=estimator, **WITHOUT_HANDS)
    response = bench.ask(ReloadLanguage, "reload_language", ReloadLanguage.Request(path=pointing))
    assert not response.success
    assert "is refused, the language stays" in response.message
    assert "right_index" in response.message
    assert node.facts()["language"] == "pool"
