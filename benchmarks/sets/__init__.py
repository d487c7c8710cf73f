"""Sets of recorded and drawn movements, and how demonstrations are drawn from them."""
