"""Keypoint files of other programs as recordings: OpenPose, MediaPipe, DeepLabCut, SLEAP."""

from app.keypoint_files.reader import ReadKeypoints, is_keypoint_file, read_keypoints
from app.keypoint_files.table import KeypointOptions

__all__ = ["KeypointOptions", "ReadKeypoints", "is_keypoint_file", "read_keypoints"]
