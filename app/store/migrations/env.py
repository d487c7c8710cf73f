"""Alembic's entry: run on the connection that `Database.migrate` (or a test) hands over."""

from alembic import context
from sqlmodel import SQLModel

from app.store import models

# Importing the models fills the metadata.
assert models.Clip.__tablename__ in SQLModel.metadata.tables

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=SQLModel.metadata,
    # SQLite cannot alter columns in place; batch mode copies the table.
    render_as_batch=True,
    # Our SQLite transactions begin explicitly, so DDL rolls back with them.
    transactional_ddl=True,
)
with context.begin_transaction():
    context.run_migrations()
