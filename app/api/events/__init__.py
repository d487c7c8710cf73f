"""Server-sent events: publish and subscribe, within the server process and between servers."""
