"""Text: strict JSON, file hashes and wording of lists; nothing in it knows gestures."""
