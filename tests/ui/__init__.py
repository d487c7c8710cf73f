"""Tests of the viser side of the studio."""
