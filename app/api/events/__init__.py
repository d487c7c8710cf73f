"""Server-sent events: an event is published once, and fanned out to every open stream."""
