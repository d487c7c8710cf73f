"""The ROS 2 nodes: one module a node."""
