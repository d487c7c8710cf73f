"""HTTP without knowledge of gestures: problems, schemas, ranges, media types."""
