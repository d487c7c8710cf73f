"""Services that routes share: the running studio, views, edits, diffs, clip ranges."""
