"""Migration: pairs, the two gestures between which a take of practice or of a test set lies."""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"

_TABLES = ("labelled_result", "practice_take")


def upgrade() -> None:
    """Add the columns; no take so far has a pair."""
    for table in _TABLES:
        op.add_column(table, sa.Column("pair", sa.Text(), nullable=True))
