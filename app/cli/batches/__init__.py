"""Batches: recognises all clips of a folder, resumable, into one table."""
