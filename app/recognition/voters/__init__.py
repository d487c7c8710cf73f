"""Voters: one module each, with the voter's distance and constants; `registry` lists them."""
