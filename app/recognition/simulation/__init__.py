"""Simulation: variants of demonstrations, held poses and ordinary movement."""
