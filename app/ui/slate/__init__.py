"""Slate: a language as one printable page."""
