"""Commands for administrators of a server: tokens, audit log, backup, data folder."""
