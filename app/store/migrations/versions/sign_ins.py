"""Migration: sessions of browsers, which a log-out ends on every server."""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    """Add the table."""
    op.create_table(
        "sign_in",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("name", sa.String(80), nullable=False, index=True),
        sa.Column("proof", sa.String(64), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False, index=True),
    )
