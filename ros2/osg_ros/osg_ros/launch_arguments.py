"""Launch arguments: declared here for all launch files, with the nodes that use them."""

from __future__ import annotations

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

PACKAGE = "osg_ros"


def declare_arguments() -> list[DeclareLaunchArgument]:
    """Declare the arguments of every launch file."""
    share = Path(get_package_share_directory(PACKAGE))
    texts = {
        "image": ("image", "Topic of the pictures."),
        "namespace": ("", "Namespace of all nodes."),
        "params_file": (str(share / "config" / "gestures.yaml"), "Parameters of all nodes."),
        "autostart": ("true", "false: wait for a lifecycle manager."),
        "input": ("osg", "Keypoints that the separate recognition node uses: osg or published."),
        "log_level": ("info", "Log level of all nodes."),
    }
    return [
        DeclareLaunchArgument("language", description="Path of the language file."),
        *(
            DeclareLaunchArgument(name, default_value=default, description=description)
            for name, (default, description) in texts.items()
        ),
    ]


def create_switch(
    name: str, executable: str, *, on: bool, needed: bool = True
) -> list[DeclareLaunchArgument | Node]:
    """Create an executable's node with the launch argument that switches it on or off."""
    argument = DeclareLaunchArgument(
        name, default_value=str(on).lower(), description=f"Start the {executable}."
    )
    condition = IfCondition(LaunchConfiguration(name))
    return [argument, create_node(executable, condition, needed=needed)]


def create_node(
    executable: str, condition: IfCondition | None = None, *, needed: bool = True
) -> Node:
    """Create the node of an executable of this package from the launch arguments.

    `needed`: the launch file ends when the node ends, so that a supervisor starts all nodes again.
    """
    image = LaunchConfiguration("image")
    return Node(
        package=PACKAGE,
        executable=executable,
        namespace=LaunchConfiguration("namespace"),
        parameters=[
            LaunchConfiguration("params_file"),
            {
                "language": ParameterValue(LaunchConfiguration("language"), value_type=str),
                "autostart": ParameterValue(LaunchConfiguration("autostart"), value_type=bool),
                "input": ParameterValue(LaunchConfiguration("input"), value_type=str),
            },
        ],
        remappings=[("image", image), ("image/compressed", [image, "/compressed"])],
        arguments=["--ros-args", "--log-level", LaunchConfiguration("log_level")],
        condition=condition,
        on_exit=Shutdown(reason=f"{executable} has ended") if needed else None,
        output="screen",
    )
