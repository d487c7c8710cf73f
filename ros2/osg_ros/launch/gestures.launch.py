"""Recognise gestures and give commands, in one process.

ros2 launch osg_ros gestures.launch.py language:=/data/pool.json image:=/camera/image_raw
"""

from launch import LaunchDescription
from osg_ros.launch_arguments import arguments, node, switch


def generate_launch_description() -> LaunchDescription:
    """Return what `ros2 launch` starts."""
    pictures = switch("visualisation", "visualisation_node", on=False)
    return LaunchDescription([*arguments(), node("gesture_process"), *pictures])
