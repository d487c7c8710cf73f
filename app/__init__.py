"""OSG Studio: design gesture languages for underwater robots from one demonstration per gesture."""

__version__ = "0.4.0"
