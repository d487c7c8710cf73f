"""Tests of the sample languages and their clips."""
