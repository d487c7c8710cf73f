"""The gesture language and its file formats."""
