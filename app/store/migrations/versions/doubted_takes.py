"""Migration: invited takes that are doubted, and who added takes to test sets and practice."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"
branch_labels = None
depends_on = None

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


def downgrade() -> None:
    """Drop the columns; what is doubted is returned, and what was removed too."""
    for name in ("labelled_take", "practice_take"):
        with op.batch_alter_table(name) as table:
            table.drop_column("added_by")
    states = ("waiting", "added", "returned")
    op.execute(
        f"UPDATE invited_take SET status = 'returned' WHERE status NOT IN {states}"
        " OR (status = 'waiting' AND reason IS NOT NULL)"
    )
    with op.batch_alter_table("invited_take") as table:
        table.drop_constraint(_CHECK, type_="check")
        table.create_check_constraint(_CHECK, f"status IN {states}")
        table.drop_column("asked")
        table.drop_column("read_as")
