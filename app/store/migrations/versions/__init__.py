"""Migrations: one module per change of the tables, linked by their revision numbers."""
