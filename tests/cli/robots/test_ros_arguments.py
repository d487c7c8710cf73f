"""ROS arguments are passed to ROS 2 alone, and only with the option for it."""

from __future__ import annotations

import pytest

from app.cli.robots.ros_arguments import split_ros_arguments
from tests.command_line import OsgStudio


@pytest.mark.parametrize(
    ("given", "own", "ros"),
    [
        ("robot --ros2", "robot --ros2", ""),
        ("robot --ros-args -r a:=b", "robot", "--ros-args -r a:=b"),
        ("robot --ros-args -r a:=b -- --ros2", "robot --ros2", "--ros-args -r a:=b"),
        ("--ros-args -r a:=b -- -x --ros-args", "-x", "--ros-args -r a:=b --ros-args"),
        ("robot -- --ros2", "robot -- --ros2", ""),
    ],
)
def test_they_go_from_where_they_begin_to_where_they_end(given: str, own: str, ros: str) -> None:
    assert split_ros_arguments(given.split()) == (own.split(), ros.split())


def test_a_robot_that_is_not_to_publish_refuses_them(osg_studio: OsgStudio) -> None:
    ended = osg_studio("robot", "--language", "pool.json", "--ros-args", "-r", "__ns:=/auv")
    assert ended.code == 2
    assert "--ros-args needs --ros2: add that option" in " ".join(ended.error.split())


def test_no_other_command_takes_them(osg_studio: OsgStudio) -> None:
    ended = osg_studio("recognize", "clip.mp4", "--language", "pool.json", "--ros-args")
    assert ended.code == 2
    assert "No such option: --ros-args" in " ".join(ended.error.split())
