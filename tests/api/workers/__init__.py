"""Tests of `app.api.workers`."""
