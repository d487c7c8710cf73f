"""Tests of the ROS 2 packages, with ROS 2 itself where there are wheels of it."""
