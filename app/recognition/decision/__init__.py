"""From distances to a decision: fusion, thresholds, rejection, and the recognition result."""
