"""The robot's runtime."""
