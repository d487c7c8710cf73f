"""Dive recordings: reads rosbag2 folders and files, writes bags as MCAP.

A recording is read in place. A topic of pictures becomes a clip through the same models as a video
file, a topic of recorded keypoints without models.
"""

from app.bags.bag_kind import bag_and_topic
from app.bags.extraction import holds_keypoints, record_bag, show_recording
from app.bags.staging import is_bag
