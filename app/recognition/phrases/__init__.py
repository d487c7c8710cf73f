"""Phrases: grammars of gesture sequences, with automaton, parser and interpretation."""
