"""Uploaded files: received, inspected and stored as clips."""
