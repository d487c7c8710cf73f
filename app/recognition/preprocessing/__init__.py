"""Landmark cleaning: side swaps, outliers, quality checks, choice of salient landmarks."""
