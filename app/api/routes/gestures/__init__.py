"""Routers of a language's gestures: their demonstrations, and previews of a change."""
