"""Migration: kinds of clips by name, so that a further kind needs no column."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"


def upgrade() -> None:
    """Add the source of every clip; rename the column of keypoint options to one for any file."""
    op.add_column(
        "clip", sa.Column("source", sa.String(16), nullable=False, server_default="video")
    )
    # Not in a batch: SQLite would recreate the table, and the jobs refer to it.
    op.execute("ALTER TABLE clip RENAME COLUMN keypoints TO options")
    op.execute("UPDATE clip SET source = 'bag' WHERE topics <> '[]'")
    op.execute("UPDATE clip SET source = 'keypoints' WHERE options IS NOT NULL")
