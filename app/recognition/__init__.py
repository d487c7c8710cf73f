"""The domain core: what a robot installs."""
