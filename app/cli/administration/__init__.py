"""Commands of whoever runs a server: tokens, audit log, backup, and where its data lies."""
