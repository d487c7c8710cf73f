"""Tests of the conversion from TensorFlow Lite."""
