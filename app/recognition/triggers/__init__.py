"""Triggers begin and end a take: a salute, an arm pose, a gesture, or none."""
