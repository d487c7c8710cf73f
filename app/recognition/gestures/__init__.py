"""A gesture and its options: switches, the profile, the tuning."""
