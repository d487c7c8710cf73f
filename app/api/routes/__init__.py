"""Routers under ``/api/v1``: a package per noun, a module per concern of it."""
