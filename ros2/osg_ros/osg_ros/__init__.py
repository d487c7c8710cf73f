"""The ROS 2 nodes of OSG Studio: pictures of a camera in, gestures and confirmed commands out."""
