"""Voters: one module each, with all that is known of it; `registry` lists them."""
