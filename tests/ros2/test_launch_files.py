"""The launch files start what there is, with arguments that are declared.

`launch` is in no package index. What stands in for it here only records what it is given.
"""

from __future__ import annotations

import runpy
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.ros2.test_packages import setup_arguments
from tests.ros2.workspace import NODES


@dataclass
class Recorded:
    """What was constructed: its positional and its named arguments."""

    positional: tuple[Any, ...]
    named: dict[str, Any] = field(default_factory=dict)


class DeclareLaunchArgument(Recorded):
    """A declared argument."""


class LaunchConfiguration(Recorded):
    """An argument's value."""


class Shutdown(Recorded):
    """The end of everything that the launch file started."""


class Node(Recorded):
    """A process to start."""


def record(kind: type[Recorded]) -> Any:
    return lambda *positional, **named: kind(positional, named)


@pytest.fixture
def launch(monkeypatch: pytest.MonkeyPatch) -> None:
    recorded: dict[str, dict[str, Any]] = {
        "ament_index_python": {},
        "ament_index_python.packages": {"get_package_share_directory": lambda name: NODES},
        "launch": {"LaunchDescription": list},
        "launch.actions": {
            "DeclareLaunchArgument": record(DeclareLaunchArgument),
            "Shutdown": record(Shutdown),
        },
        "launch.conditions": {"IfCondition": record(Recorded)},
        "launch.substitutions": {"LaunchConfiguration": record(LaunchConfiguration)},
        "launch_ros": {},
        "launch_ros.actions": {"Node": record(Node)},
        "launch_ros.parameter_descriptions": {"ParameterValue": record(Recorded)},
    }
    for name, content in recorded.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, "osg_ros.launch_arguments", raising=False)


def described(name: str) -> list[Any]:
    """Return what a launch file describes."""
    path = NODES / "launch" / f"{name}.launch.py"
    made: list[Any] = runpy.run_path(str(path))["generate_launch_description"]()
    return made


def used(value: Any) -> set[str]:
    """Return the names of all arguments whose values lie anywhere in `value`."""
    if isinstance(value, LaunchConfiguration):
        return {value.positional[0]}
    if isinstance(value, Recorded):
        return used(value.positional) | used(value.named)
    if isinstance(value, dict):
        return used(list(value.values()))
    if isinstance(value, list | tuple):
        return set[str]().union(*(used(each) for each in value))
    return set()


@pytest.mark.usefixtures("launch")
@pytest.mark.parametrize(
    ("name", "executables"),
    [
        ("gestures", ["gesture_process", "visualisation_node"]),
        (
            "separate_nodes",
            ["pose_node", "hand_node", "recognition_node", "command_node", "visualisation_node"],
        ),
    ],
)
def test_a_launch_file_starts_what_exists_with_arguments_that_are_declared(
    name: str, executables: list[str]
) -> None:
    actions = described(name)
    nodes = [action.named for action in actions if isinstance(action, Node)]
    assert [node["executable"] for node in nodes] == executables
    scripts = setup_arguments()["entry_points"]["console_scripts"]
    assert set(executables) <= {script.split(" = ")[0] for script in scripts}
    declared = [
        action.positional[0] for action in actions if isinstance(action, DeclareLaunchArgument)
    ]
    assert len(set(declared)) == len(declared)
    assert used(nodes) == set(declared)
    assert {node["package"] for node in nodes} == {"osg_ros"}
    # A robot without one of its nodes is deaf; without its pictures it is not.
    ending = {node["executable"] for node in nodes if isinstance(node["on_exit"], Shutdown)}
    assert ending == set(executables) - {"visualisation_node"}


@pytest.mark.usefixtures("launch")
def test_only_the_language_has_to_be_given_and_every_argument_is_described() -> None:
    arguments = [
        action for action in described("gestures") if isinstance(action, DeclareLaunchArgument)
    ]
    needed = [each.positional[0] for each in arguments if "default_value" not in each.named]
    assert needed == ["language"]
    assert all(each.named["description"].endswith(".") for each in arguments)
    defaults = {each.positional[0]: each.named.get("default_value") for each in arguments}
    assert Path(str(defaults["params_file"])).is_file()
