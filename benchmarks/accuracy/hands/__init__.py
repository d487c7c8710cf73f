"""Hand shapes: how often held ones, moving ones and sequences are recognised."""
