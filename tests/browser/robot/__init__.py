"""The page of a robot in a real browser."""
