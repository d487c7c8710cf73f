"""Uploads: receive a file, probe it, store it as a clip."""
