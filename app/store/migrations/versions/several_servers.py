"""Migration: several servers on one database, with the owner of a job and a change counter."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"


def upgrade() -> None:
    """Add the columns, empty for jobs so far, and the table with its one row."""
    op.add_column("job", sa.Column("server", sa.String(32), nullable=True))
    op.add_column("job", sa.Column("lease", sa.DateTime(), nullable=True))
    count = op.create_table(
        "change_count",
        sa.Column("id", sa.Integer(), primary_key=True),
        sa.Column("changes", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
    )
    op.bulk_insert(count, [{"id": 1, "changes": 0}])
