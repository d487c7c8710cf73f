"""Voters: one class each, with the voter's distance and constants; `registry` lists them."""
