"""From recognitions to confirmed commands, without ROS."""
