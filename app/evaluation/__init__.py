"""Evaluation: measures recognition rates on variants and on labelled clips."""
