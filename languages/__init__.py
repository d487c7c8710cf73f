"""Sample languages, their clips, and the programs that make both."""
