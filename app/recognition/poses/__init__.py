"""Poses: landmark names, the landmarks of one frame, pose sequences and trajectories."""
