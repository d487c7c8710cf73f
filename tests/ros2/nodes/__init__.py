"""Tests that need ROS 2: real rclpy, real messages, real DDS."""
