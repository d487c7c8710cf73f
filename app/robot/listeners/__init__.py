"""Listeners: turn landmarks into recognitions, between salutes, without salutes, and as phrases."""
