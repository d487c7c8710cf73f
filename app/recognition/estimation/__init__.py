"""Pose and hand landmarks from images: one protocol, several backends."""
