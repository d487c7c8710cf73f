"""Pose and hand landmarks from images: one protocol, two backends."""
