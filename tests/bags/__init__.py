"""Dive recordings: what is read from bags that the tests write, and what is written to MCAP."""
