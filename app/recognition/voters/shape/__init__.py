"""Shape voters: compare the trajectory images of a query and a gesture."""
