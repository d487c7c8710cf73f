"""Routers of administration: sign-in, audit log, metrics."""
