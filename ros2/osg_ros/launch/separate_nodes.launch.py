"""Launch file: recognises gestures with one process per node, as the published port does.

Every node can be switched off and replaced by another.

ros2 launch osg_ros separate_nodes.launch.py language:=/data/pool.json pose:=false
"""

from launch import LaunchDescription
from osg_ros.launch_arguments import create_switch, declare_arguments


def generate_launch_description() -> LaunchDescription:
    """Return the description that `ros2 launch` starts."""
    return LaunchDescription(
        [
            *declare_arguments(),
            *create_switch("pose", "pose_node", on=True),
            *create_switch("hand", "hand_node", on=True),
            *create_switch("recognition", "recognition_node", on=True),
            *create_switch("command", "command_node", on=True),
            *create_switch("visualisation", "visualisation_node", on=True, needed=False),
        ]
    )
