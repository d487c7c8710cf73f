"""Measurements. Speed is told as ratios of two things in one run, never as absolute times."""
