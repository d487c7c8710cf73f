"""Routers of clips: upload, timeline, export."""
