"""Keypoint files of other programs."""
