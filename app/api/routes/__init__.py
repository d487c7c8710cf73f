"""Routers under ``/api/v1``, one per noun."""
