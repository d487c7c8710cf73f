"""Commands: decides which recognised gestures and phrases become commands, without ROS."""
