"""Voters that compare movements: path, posture, order and time."""
