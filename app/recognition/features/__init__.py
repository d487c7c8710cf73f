"""Features of a movement: its trajectory image and contour, its motion, its traversals."""
