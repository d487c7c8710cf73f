"""Explanations of recognitions: vote breakdown, alignments, differences, counterfactuals."""
