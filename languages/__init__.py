"""Sample languages, the clips they came from, and what makes both."""
