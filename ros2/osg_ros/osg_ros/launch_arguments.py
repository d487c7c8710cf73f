"""What the launch files share: their arguments, and a node that obeys them."""

from __future__ import annotations

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

PACKAGE = "osg_ros"


def arguments() -> list[DeclareLaunchArgument]:
    """Return the arguments of every launch file."""
    share = Path(get_package_share_directory(PACKAGE))
    texts = {
        "image": ("image", "Topic of the pictures."),
        "namespace": ("", "Namespace of all nodes."),
        "params_file": (str(share / "config" / "gestures.yaml"), "Parameters of all nodes."),
        "autostart": ("true", "false: wait for a lifecycle manager."),
        "input": ("osg", "Whose keypoints the separate recognition node hears: osg or published."),
        "log_level": ("info", "Of all nodes."),
    }
    return [
        DeclareLaunchArgument("language", description="Path of the language file."),
        *(
            DeclareLaunchArgument(name, default_value=default, description=description)
            for name, (default, description) in texts.items()
        ),
    ]


def switch(name: str, executable: str, *, on: bool) -> list[DeclareLaunchArgument | Node]:
    """Return an executable with the argument that starts it or not."""
    argument = DeclareLaunchArgument(
        name, default_value=str(on).lower(), description=f"Start the {executable}."
    )
    return [argument, node(executable, IfCondition(LaunchConfiguration(name)))]


def node(executable: str, condition: IfCondition | None = None) -> Node:
    """Return an executable of this package with all that the arguments say."""
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
        output="screen",
    )
