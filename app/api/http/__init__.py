"""HTTP building blocks: problems, schemas, ranges, ETags, images."""
