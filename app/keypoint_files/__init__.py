"""Readers of keypoint files: OpenPose, MediaPipe, DeepLabCut, SLEAP."""

from app.keypoint_files.keypoint_table import KeypointOptions
from app.keypoint_files.reader import ReadKeypoints, read_keypoints
from app.keypoint_files.registry import ENDINGS, Ending, is_keypoint_file, keypoint_ending
from app.keypoint_files.staging import is_openpose_archive, stage
