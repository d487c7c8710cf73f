"""Routers of the samples that come with the program."""
