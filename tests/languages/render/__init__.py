"""Tests of how the sample clips are composed; rendering itself is not needed to test."""
