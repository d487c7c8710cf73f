"""Worker processes that read clips: a file that crashes a decoder ends its own job only."""
