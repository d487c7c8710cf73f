"""Migration: takes of test sets whose gesture got another movement."""

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"


def upgrade() -> None:
    """Add the column; of takes so far nobody knows, and they count."""
    op.add_column("labelled_take", sa.Column("former", sa.Text(), nullable=True))
