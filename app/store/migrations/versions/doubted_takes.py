"""Migration: invited takes that are doubted, and who added takes to test sets and practice."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"

_CHECK = "invited_take_status"


def upgrade() -> None:
    """Allow the states of doubted takes, and add the columns."""
    with op.batch_alter_table("invited_take") as table:
        table.drop_constraint(_CHECK, type_="check")
        states = "status IN ('waiting', 'asked', 'added', 'removed', 'returned')"
        table.create_check_constraint(_CHECK, states)
        table.add_column(sa.Column("read_as", sa.String(200), nullable=True))
        table.add_column(sa.Column("asked", sa.DateTime(), nullable=True))
    for name in ("labelled_take", "practice_take"):
        column = sa.Column("added_by", sa.String(80), nullable=False, server_default="")
        op.add_column(name, column)
