"""Landmark models: neural networks for bodies and hands, with pre- and post-processing."""
