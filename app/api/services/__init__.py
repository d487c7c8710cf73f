"""What routes share: the running studio, edits of gestures, documents, event streams."""
