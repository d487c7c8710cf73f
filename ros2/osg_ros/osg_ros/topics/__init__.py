"""Messages and topics: what the nodes publish and subscribe to."""
