"""Text formats without knowledge of gestures: strict JSON, hashing, wording."""
