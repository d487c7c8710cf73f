"""Topics and messages that the nodes publish and subscribe to."""
