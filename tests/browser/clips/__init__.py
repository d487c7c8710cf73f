"""Clips in the browser: files, recordings, ranges, waiting for poses."""
