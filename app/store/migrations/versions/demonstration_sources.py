"""Migration: the clip of each demonstration, so that a gesture is edited with its clip."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Create the table; the sources of gestures saved before are unknown."""
    op.create_table(
        "demonstration_source",
        sa.Column("trajectory", sa.String(64), primary_key=True),
        sa.Column("clip_id", sa.String(32), nullable=False, index=True),
        sa.Column("start", sa.Float(), nullable=False),
        sa.Column("end", sa.Float(), nullable=False),
        sa.Column("keep_transit", sa.Boolean(), nullable=False),
        sa.ForeignKeyConstraint(["clip_id"], ["clip.id"], ondelete="CASCADE"),
    )
