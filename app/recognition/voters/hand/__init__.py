"""Hand voters: compare the shape of a held hand in a query and a gesture."""
