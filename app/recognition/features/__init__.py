"""Features: trajectory images and their contours, movements and their traversals."""
