"""Launch file: recognises gestures and gives commands in one process.

ros2 launch osg_ros gestures.launch.py language:=/data/pool.json image:=/camera/image_raw
"""

from launch import LaunchDescription
from osg_ros.launch_arguments import create_node, create_switch, declare_arguments


def generate_launch_description() -> LaunchDescription:
    """Return the description that `ros2 launch` starts."""
    pictures = create_switch("visualisation", "visualisation_node", on=False, needed=False)
    return LaunchDescription([*declare_arguments(), create_node("gesture_process"), *pictures])
