"""Dive recordings: rosbag2 folders and files in, sessions as MCAP out.

A recording is read in place. An image topic becomes a clip by way of the same models as a video
file, and a topic of recorded keypoints becomes one without them.
"""

from app.bags.kind import BagKind, bag_kind, is_bag

__all__ = ["BagKind", "bag_kind", "is_bag"]
