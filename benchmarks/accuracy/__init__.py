"""Accuracy: labels, rejection and confidence on movements of other people."""
