"""Alembic migrations, shipped with the package and run at every start (`Database.migrate`)."""
