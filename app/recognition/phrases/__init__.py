"""Phrases: the grammar of gesture sequences, its automaton, parser and interpretation."""
