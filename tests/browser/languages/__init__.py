"""Views of a language in the browser: library, gestures, phrases, health, practice."""
