"""Tests of `app.api.extraction`."""
