"""Server-sent events: publish/subscribe within the server process."""
