"""The laboratory: how well gestures are recognised, on variants and on a user's own clips."""
