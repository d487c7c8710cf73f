"""From a video to takes: decoding, extraction of landmarks, salutes, segmentation, trimming."""
