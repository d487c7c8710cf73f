"""Landmarks over time: their names, one frame, a pose sequence, a normalised trajectory."""
