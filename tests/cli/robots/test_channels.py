"""Without ROS 2 the option `--ros2` says what is missing; with it, see tests/ros2/nodes."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.command_line import OsgStudio


@pytest.mark.usefixtures("installed_models")
def test_without_the_packages_it_is_said_what_to_do(
    osg_studio: OsgStudio, sample_clips: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "osg_ros.nodes.robot_node", None)
    language = sample_clips.parent / "osg-table-1.json"
    clip = sample_clips / "circle-test-1.mp4"
    ended = osg_studio("robot", "--ros2", "--language", language, "--source", clip)
    assert ended.code == 2
    assert "--ros2 needs ROS 2" in ended.error
    assert "osg_ros.nodes.robot_node is missing" in ended.error
    assert ended.out == ""
