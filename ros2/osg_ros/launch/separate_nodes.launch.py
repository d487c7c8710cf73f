"""The same with a process per node, as the published port has it; each can be left to another.

ros2 launch osg_ros separate_nodes.launch.py language:=/data/pool.json pose:=false
"""

from launch import LaunchDescription
from osg_ros.launch_arguments import arguments, switch


def generate_launch_description() -> LaunchDescription:
    """Return what `ros2 launch` starts."""
    return LaunchDescription(
        [
            *arguments(),
            *switch("pose", "pose_node", on=True),
            *switch("hand", "hand_node", on=True),
            *switch("recognition", "recognition_node", on=True),
            *switch("command", "command_node", on=True),
            *switch("visualisation", "visualisation_node", on=True),
        ]
    )
