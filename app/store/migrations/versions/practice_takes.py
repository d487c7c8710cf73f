"""Migration: practice takes, the gestures that divers were asked to show and their recognitions."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "practice_take",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("language_id", sa.String(32), nullable=False, index=True),
        sa.Column("clip_id", sa.String(32), nullable=False, index=True),
        sa.Column("start", sa.Float(), nullable=False),
        sa.Column("diver", sa.String(80), nullable=False),
        sa.Column("expected", sa.String(200), nullable=False),
        sa.Column("label", sa.String(200), nullable=True),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("recognition_id", sa.String(32), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(["language_id"], ["language.id"], ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["clip_id"], ["clip.id"], ondelete="CASCADE"),
    )
