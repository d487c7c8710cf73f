"""Tests of the models: obtaining, keeping and converting them."""
