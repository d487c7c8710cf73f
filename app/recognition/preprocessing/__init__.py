"""Preprocessing: repair of landmarks, quality checks, and the choice of salient landmarks."""
