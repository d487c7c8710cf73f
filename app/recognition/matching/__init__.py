"""Sequence matching: dynamic time warping (DTW) and the distances between steps it uses."""
