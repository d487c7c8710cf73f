"""Tests of archives and of the service manager."""
