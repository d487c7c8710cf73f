"""Simulated movements: variants of a demonstration, background motion, error rate estimates."""
