"""Commands: turn recognitions into confirmed commands, without ROS."""
