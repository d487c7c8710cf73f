"""Commands for robots: the runtime, its events and stages, and ROS 2."""
