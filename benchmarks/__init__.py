"""Benchmarks: speed as ratios of two things in one run, never as absolute times, and accuracy."""
