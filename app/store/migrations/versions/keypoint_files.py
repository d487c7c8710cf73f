"""Migration: clips of another program's keypoint file."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the column; clips so far are videos and dive recordings."""
    with op.batch_alter_table("clip") as table:
        table.add_column(sa.Column("keypoints", sa.Text(), nullable=True))
