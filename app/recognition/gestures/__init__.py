"""Gestures: demonstrations and their options (switches), profiles and tuning."""
