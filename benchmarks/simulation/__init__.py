"""Simulation: compares simulated takes with those of people."""
