"""Routers of languages: files, revisions, health reports, phrases, pairs of gestures."""
