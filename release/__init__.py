"""Release: builds wheel and source distribution, and what goes with them."""
