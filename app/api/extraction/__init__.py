"""Clips are read in processes of their own: a file that crashes a decoder ends only its job."""
