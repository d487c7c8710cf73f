"""Every node can be configured, activated, stopped and begun again, by service and in words."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from osg_interfaces.msg import RecognizerState
from rclpy.lifecycle import TransitionCallbackReturn

from app.recognition import OsgError
from osg_ros.nodes.command_node import CommandNode
from osg_ros.nodes.gesture_node import GestureNode
from osg_ros.nodes.hand_node import HandNode
from osg_ros.nodes.managed_node import ManagedNode
from osg_ros.nodes.pose_node import PoseNode
from osg_ros.nodes.process import run_nodes
from osg_ros.nodes.recognition_node import RecognitionNode
from osg_ros.nodes.robot_node import run_robot_node
from osg_ros.nodes.visualisation_node import VisualisationNode
from tests.ros2.nodes.bench import LATCHED, Bench, state_of

NODES = (
    CommandNode,
    GestureNode,
    HandNode,
    PoseNode,
    RecognitionNode,
    VisualisationNode,
)
SPEAKING = (GestureNode, RecognitionNode)
SUCCESS, FAILURE = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE


@pytest.mark.usefixtures("installed_models")
@pytest.mark.parametrize("kind", NODES)
def test_a_node_goes_through_its_life_twice(
    bench: Bench, kind: type[ManagedNode], language_file: Path
) -> None:
    spoken = {"language": str(language_file)} if kind in SPEAKING else {}
    node = bench.add(kind, **spoken)
    for _ in range(2):
        assert node.trigger_configure() == SUCCESS
        assert node.trigger_activate() == SUCCESS
        assert node.trigger_deactivate() == SUCCESS
        assert node.trigger_cleanup() == SUCCESS
    assert node.trigger_configure() == SUCCESS
    assert node.trigger_activate() == SUCCESS
    assert node.trigger_shutdown() == SUCCESS
    assert state_of(node) == State.PRIMARY_STATE_FINALIZED


def test_a_lifecycle_manager_does_it_by_service_in_the_nodes_namespace(
    bench: Bench, language_file: Path
) -> None:
    bench.add(RecognitionNode, namespace="auv", language=str(language_file))
    for transition in (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
        request = ChangeState.Request(transition=Transition(id=transition))
        assert bench.ask(ChangeState, "/auv/recognition_node/change_state", request).success
    answer = bench.ask(GetState, "/auv/recognition_node/get_state", GetState.Request())
    assert answer.current_state.id == State.PRIMARY_STATE_ACTIVE


@pytest.mark.parametrize(
    ("kind", "wrong", "expected"),
    [
        (RecognitionNode, {}, "parameter language is empty"),
        (RecognitionNode, {"language": "nowhere.json"}, "nowhere.json"),
        (RecognitionNode, {"language": __file__}, "JSON"),
        (RecognitionNode, {"language": "x", "profile": "best"}, "profile is 'best'"),
        (GestureNode, {"estimator": "openpose"}, "unknown backend 'openpose'"),
        (CommandNode, {"language": __file__}, "not a language file with a checksum"),
        (CommandNode, {"cancel": ["line"], "emergency": ["line"]}, "'line'"),
    ],
)
@pytest.mark.withstands(row="H27")
def test_a_node_that_cannot_be_configured_stays_so_and_says_why(
    bench: Bench, kind: type[ManagedNode], wrong: dict[str, Any], expected: str
) -> None:
    reports = bench.subscribe(DiagnosticArray, "/diagnostics")
    node = bench.add(kind, diagnostic_period=0.1, **wrong)
    bench.wait(lambda: bool(reports), "diagnostics")
    assert node.trigger_configure() == FAILURE
    assert state_of(node) == State.PRIMARY_STATE_UNCONFIGURED
    bench.wait(lambda: reports[-1].status[0].level == DiagnosticStatus.ERROR, "an error")
    message = next(
        report.status[0].message
        for report in reports
        if report.status[0].level == DiagnosticStatus.ERROR
    )
    assert expected in message
    assert "\n" not in message


def test_what_was_refused_can_be_corrected(bench: Bench, language_file: Path) -> None:
    from rclpy.parameter import Parameter

    node = bench.add(RecognitionNode)
    assert node.trigger_configure() == FAILURE
    node.set_parameters([Parameter("language", value=str(language_file))])
    assert node.trigger_configure() == SUCCESS


def test_a_node_that_is_stopped_is_told_to_be_inactive(bench: Bench, language_file: Path) -> None:
    states = bench.subscribe(RecognizerState, "state", LATCHED)
    node = bench.active(RecognitionNode, language=str(language_file))
    bench.wait(lambda: len(states) == 1, "state")
    assert node.trigger_deactivate() == SUCCESS
    bench.wait(lambda: len(states) == 2, "second state")
    assert [state.state for state in states] == [RecognizerState.IDLE, RecognizerState.INACTIVE]


@pytest.mark.usefixtures("domain")
def test_arguments_that_ros_does_not_understand_are_told() -> None:
    arguments = ["--ros-args", "-r", "recognition"]
    with pytest.raises(OsgError, match="does not understand --ros-args -r recognition"):
        run_robot_node(arguments).__enter__()


def test_a_node_that_was_shut_down_by_a_manager_ends_with_its_process(domain: int) -> None:
    rclpy.init(domain_id=domain)
    try:
        node = CommandNode()
        with run_nodes([node]):
            assert node.trigger_shutdown() == SUCCESS
        assert node.finished
    finally:
        rclpy.try_shutdown()
