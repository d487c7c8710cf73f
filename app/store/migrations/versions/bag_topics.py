"""Migration: clips of a topic of a dive recording."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Add the columns; clips so far are video files."""
    with op.batch_alter_table("clip") as table:
        table.add_column(sa.Column("topics", sa.Text(), nullable=False, server_default="[]"))
        table.add_column(sa.Column("topic", sa.String(255), nullable=True))
