"""ROS 2 nodes of OSG Studio: turn camera pictures into gestures and confirmed commands."""
