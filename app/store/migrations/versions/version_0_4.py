"""Migration: version 0.4.0, with doubted takes, former movements, and the newest job of a clip."""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0016"

_CHECK = "invited_take_status"


def upgrade() -> None:
    """Allow the states of doubted takes, and add the columns.

    Of takes so far nobody knows whether their gesture has got another movement: they count.
    """
    with op.batch_alter_table("invited_take") as table:
        table.drop_constraint(_CHECK, type_="check")
        states = "status IN ('waiting', 'asked', 'added', 'removed', 'returned')"
        table.create_check_constraint(_CHECK, states)
        table.add_column(sa.Column("read_as", sa.String(200), nullable=True))
        table.add_column(sa.Column("asked", sa.DateTime(), nullable=True))
    for name in ("labelled_take", "practice_take"):
        column = sa.Column("added_by", sa.String(80), nullable=False, server_default="")
        op.add_column(name, column)
    op.add_column("labelled_take", sa.Column("former", sa.Text(), nullable=True))
    op.add_column("clip", sa.Column("job_id", sa.String(32), nullable=False, server_default=""))
    newest = "SELECT id FROM job WHERE clip_id = clip.id ORDER BY created DESC LIMIT 1"
    op.execute(f"UPDATE clip SET job_id = coalesce(({newest}), '')")
