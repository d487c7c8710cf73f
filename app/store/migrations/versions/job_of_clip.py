"""Migration: each clip names its newest job, so that no list loads all jobs."""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"


def upgrade() -> None:
    """Add the column, and fill it with the newest job of each clip."""
    op.add_column("clip", sa.Column("job_id", sa.String(32), nullable=False, server_default=""))
    newest = "SELECT id FROM job WHERE clip_id = clip.id ORDER BY created DESC LIMIT 1"
    op.execute(f"UPDATE clip SET job_id = coalesce(({newest}), '')")
