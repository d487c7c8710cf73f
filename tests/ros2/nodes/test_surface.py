"""What a robot's other nodes see: names, types, quality of service, parameters, diagnostics."""

from __future__ import annotations

import re
import shlex
import time
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from osg_interfaces.msg import ActiveLanguage, RecognizerState
from rcl_interfaces.srv import DescribeParameters, ListParameters
from rclpy.exceptions import InvalidParameterValueException
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy

from osg_ros.nodes.command_node import CommandNode
from osg_ros.nodes.gesture_node import GestureNode
from osg_ros.nodes.managed_node import ManagedNode
from osg_ros.nodes.recognition_node import RecognitionNode
from osg_ros.nodes.visualisation_node import VisualisationNode
from tests.ros2.nodes.bench import LATCHED, Bench
from tests.ros2.nodes.test_lifecycle import NODES
from tests.ros2.workspace import ROOT

TOPICS = {
    "/auv/body_keypoints": "osg_interfaces/msg/BodyKeypoints",
    "/auv/classification": "vision_msgs/msg/Classification",
    "/auv/hand_keypoints": "keypoints_interfaces/msg/HandKeypointsArray",
    "/auv/hands": "osg_interfaces/msg/Hands",
    "/auv/humans/bodies/diver/skeleton2d": "hri_msgs/msg/Skeleton2D",
    "/auv/humans/bodies/tracked": "hri_msgs/msg/IdsList",
    "/auv/language": "osg_interfaces/msg/ActiveLanguage",
    "/auv/phrase": "osg_interfaces/msg/Phrase",
    "/auv/pose_keypoints": "keypoints_interfaces/msg/PoseKeypointsArray",
    "/auv/recognition": "osg_interfaces/msg/GestureRecognition",
    "/auv/recognized_gesture": "std_msgs/msg/String",
    "/auv/state": "osg_interfaces/msg/RecognizerState",
    "/auv/vulcan_salute_detected": "std_msgs/msg/Bool",
}
EXECUTABLES = {"command_node": (CommandNode,), "gesture_process": (GestureNode, CommandNode)}
DOCUMENTED = [
    command
    for page in sorted((ROOT / "docs" / "robots").glob("ros2-*.md"))
    for command in re.findall(r"^ros2 run osg_ros (.+)$", page.read_text("utf-8"), re.MULTILINE)
]
DROP_IN = ("pose_keypoints", "hand_keypoints", "vulcan_salute_detected", "recognized_gesture")


def endpoints(node: ManagedNode, topic: str) -> list[Any]:
    """Return a node's own publishers and subscriptions of a topic, as the ROS graph has them."""
    found = node.get_publishers_info_by_topic(topic) + node.get_subscriptions_info_by_topic(topic)
    return [each for each in found if each.node_name == node.get_name()]


def profile_of(bench: Bench, node: ManagedNode, topic: str) -> QoSProfile:
    """Return a node's quality of service on a topic, once the ROS graph has it."""
    bench.wait(lambda: bool(endpoints(node, topic)), f"{node.get_name()} on {topic}")
    (endpoint,) = endpoints(node, topic)
    return endpoint.qos_profile


@pytest.mark.usefixtures("installed_models")
def test_all_topics_lie_in_the_nodes_namespace(bench: Bench, language_file: Path) -> None:
    node = bench.active(GestureNode, namespace="auv", language=str(language_file))
    found = dict(
        node.get_publisher_names_and_types_by_node("gesture_node", "/auv", no_demangle=False)
    )
    of_rclpy = {
        "/auv/gesture_node/transition_event",
        "/diagnostics",
        "/parameter_events",
        "/rosout",
    }
    assert set(found) - of_rclpy == set(TOPICS)
    assert all(found[topic] == [kind] for topic, kind in TOPICS.items())
    listened = node.get_subscriber_names_and_types_by_node("gesture_node", "/auv")
    assert ("/auv/image", ["sensor_msgs/msg/Image"]) in listened


@pytest.mark.usefixtures("installed_models")
@pytest.mark.parametrize("line", DOCUMENTED)
def test_a_documented_command_listens_where_it_says(
    bench: Bench, line: str, language_file: Path
) -> None:
    executable, *arguments = shlex.split(line.replace("/data/pool.json", str(language_file)))
    nodes = [bench.active(kind, arguments=arguments) for kind in EXECUTABLES[executable]]
    topics = re.findall(r"-r \w+:=(\S+)", line)
    assert topics
    bench.wait(
        lambda: all(any(endpoints(node, topic) for node in nodes) for topic in topics),
        f"node on {topics}",
    )


def test_topics_can_be_remapped(bench: Bench) -> None:
    remapped = ["--ros-args", "-r", "image:=/zed/left/image", "-r", "processed_frames:=overlay"]
    node = bench.active(VisualisationNode, namespace="auv", arguments=remapped)
    published = dict(node.get_publisher_names_and_types_by_node("visualisation_node", "/auv"))
    listened = dict(node.get_subscriber_names_and_types_by_node("visualisation_node", "/auv"))
    assert "/auv/overlay" in published
    assert "/zed/left/image" in listened


@pytest.mark.usefixtures("installed_models")
def test_sensor_data_is_best_effort_and_state_is_kept_for_those_who_come_later(
    bench: Bench, language_file: Path
) -> None:
    node = bench.active(GestureNode, language=str(language_file))
    reliable, best_effort = QoSReliabilityPolicy.RELIABLE, QoSReliabilityPolicy.BEST_EFFORT
    for topic in ("image", "body_keypoints", "hands"):
        assert profile_of(bench, node, topic).reliability == best_effort
    for topic in DROP_IN:
        assert profile_of(bench, node, topic).reliability == reliable
    for topic in ("state", "language"):
        assert profile_of(bench, node, topic).durability == QoSDurabilityPolicy.TRANSIENT_LOCAL


def test_an_operator_can_ask_for_another_quality_of_service_of_one_topic(bench: Bench) -> None:
    override = "qos_overrides./body_keypoints.subscription.reliability"
    node = bench.active(VisualisationNode, **{override: "reliable"})
    other = profile_of(bench, node, "hands")  # subscribed to later
    assert other.reliability == QoSReliabilityPolicy.BEST_EFFORT
    profile = profile_of(bench, node, "body_keypoints")
    assert profile.reliability == QoSReliabilityPolicy.RELIABLE


@pytest.mark.usefixtures("installed_models")
@pytest.mark.parametrize("kind", [GestureNode, RecognitionNode])
def test_who_comes_later_hears_the_state_and_the_language_before_any_picture(
    bench: Bench, kind: type[GestureNode | RecognitionNode], language_file: Path
) -> None:
    bench.active(kind, language=str(language_file))
    states = bench.subscribe(RecognizerState, "state", LATCHED)
    languages = bench.subscribe(ActiveLanguage, "language", LATCHED)
    bench.wait(lambda: bool(states and languages), "state and language")
    assert states[0].state == RecognizerState.IDLE
    assert list(languages[0].labels) == ["circle", "wedge", "three"]
    assert languages[0].commands[0] == "Signal readiness"


@pytest.mark.parametrize("kind", NODES)
def test_every_parameter_is_described(bench: Bench, kind: type[CommandNode]) -> None:
    node = bench.add(kind)
    name = node.get_name()
    listed = bench.ask(ListParameters, f"/{name}/list_parameters", ListParameters.Request())
    names = [each for each in listed.result.names if "qos_overrides" not in each]
    ours = [each for each in names if not each.startswith(("use_sim_time", "start_type"))]
    request = DescribeParameters.Request(names=ours)
    answer = bench.ask(DescribeParameters, f"/{name}/describe_parameters", request)
    assert "autostart" in ours
    for descriptor in answer.descriptors:
        assert descriptor.description.endswith("."), descriptor.name
        assert "when the node is configured" in descriptor.additional_constraints


@pytest.mark.parametrize(
    ("kind", "wrong"),
    [(GestureNode, {"threads": 0}), (CommandNode, {"least_confidence": 1.5})],
)
def test_a_number_out_of_its_range_is_refused(
    bench: Bench, kind: type[CommandNode], wrong: dict[str, Any]
) -> None:
    with pytest.raises(InvalidParameterValueException):
        bench.add(kind, **wrong)


def test_diagnostics_tell_the_language_and_warn_when_nothing_comes(
    bench: Bench, language_file: Path
) -> None:
    reports = bench.subscribe(DiagnosticArray, "/diagnostics")
    node = bench.active(RecognitionNode, language=str(language_file), diagnostic_period=0.1)
    bench.wait(
        lambda: any(each.status[0].level != DiagnosticStatus.OK for each in reports), "warning"
    )
    status = reports[-1].status[0]
    assert status.level == DiagnosticStatus.WARN
    assert status.name == "/recognition_node"
    assert status.message.startswith("nothing on keypoints for")
    values = {value.key: value.value for value in status.values}
    assert values["language"] == "Table 1: three signs"
    assert values["messages"] == "0"
    assert node.trigger_deactivate()
    count = len(reports)
    bench.wait(lambda: len(reports) > count + 1, "further reports")
    assert reports[-1].status[0].message == "not active"


def test_a_diver_who_says_nothing_is_no_fault(bench: Bench) -> None:
    node = bench.active(CommandNode)
    later = time.monotonic() + 3600
    status = node.health.report(later, 1.0, {}).status[0]
    assert (status.level, status.message) == (DiagnosticStatus.OK, "working")
