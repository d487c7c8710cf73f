"""Simulation: variants of demonstrations, out-of-vocabulary movements, and estimated rates."""
