"""What every view of the page shares: links, keys, looks, sessions, restarts."""
