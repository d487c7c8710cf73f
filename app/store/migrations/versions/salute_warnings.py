"""Migration: the warnings of a clip that concern salutes, apart from its other ones."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"


def upgrade() -> None:
    """Add the column; of clips so far nobody knows which warnings concern salutes."""
    column = sa.Column("salute_warnings", sa.Text(), nullable=False, server_default="[]")
    op.add_column("job", column)
