"""Observation of a server: request and job ids, structured logs, metrics."""
