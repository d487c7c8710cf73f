"""ROS 2 nodes: one module for each node."""
