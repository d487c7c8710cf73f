"""Dynamic time warping (DTW): alignments of two sequences and their cost."""
