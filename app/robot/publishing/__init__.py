"""Recognitions published to other programs in the network."""
