"""Recordings: video decoding, extraction of landmarks, salutes, segmentation into takes."""
