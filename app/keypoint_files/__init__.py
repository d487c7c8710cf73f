"""Keypoint files of other programs as recordings: OpenPose, MediaPipe, DeepLabCut, SLEAP."""

from app.keypoint_files.file_kind import Ending, keypoint_ending
from app.keypoint_files.reader import ReadKeypoints, is_keypoint_file, read_keypoints
from app.keypoint_files.staging import is_openpose_archive, placed
from app.keypoint_files.table import KeypointOptions

__all__ = [
    "Ending",
    "KeypointOptions",
    "ReadKeypoints",
    "is_keypoint_file",
    "is_openpose_archive",
    "keypoint_ending",
    "placed",
    "read_keypoints",
]
