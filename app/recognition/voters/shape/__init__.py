"""Voters that compare drawings: the trajectory images of a query and a gesture."""
