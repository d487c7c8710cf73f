"""Migration: test sets, which are labelled takes of a language and their results."""

import json

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"

_recognitions = sa.table(
    "recognition",
    sa.column("id", sa.String()),
    sa.column("clip_id", sa.String()),
    sa.column("language_id", sa.String()),
    sa.column("start", sa.Float()),
    sa.column("end", sa.Float()),
    sa.column("expected", sa.String()),
    sa.column("result", sa.Text()),
    sa.column("created", sa.DateTime()),
)


def upgrade() -> None:
    """Create the tables; fill the first from the recognitions that served as the test until now."""
    takes = op.create_table(
        "labelled_take",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("language_id", sa.String(32), nullable=False, index=True),
        sa.Column("clip_id", sa.String(32), nullable=False, index=True),
        sa.Column("start", sa.Float(), nullable=False),
        sa.Column("end", sa.Float(), nullable=False),
        sa.Column("expected", sa.String(200), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(["language_id"], ["language.id"], ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["clip_id"], ["clip.id"], ondelete="CASCADE"),
        sa.UniqueConstraint("language_id", "clip_id", "start", name="labelled_range"),
    )
    op.create_table(
        "labelled_result",
        sa.Column("take_id", sa.String(32), primary_key=True),
        sa.Column("revision", sa.Integer(), primary_key=True),
        sa.Column("recognition_id", sa.String(32), nullable=True),
        sa.Column("label", sa.String(200), nullable=True),
        sa.Column("nearest", sa.String(200), nullable=True),
        sa.Column("confidence", sa.Float(), nullable=False),
        sa.Column("fault", sa.Text(), nullable=True),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(["take_id"], ["labelled_take.id"], ondelete="CASCADE"),
    )
    newest: dict[tuple[str, str, float], sa.Row[tuple[object, ...]] | None] = {}
    for row in op.get_bind().execute(
        sa.select(_recognitions).order_by(_recognitions.c.created.desc())
    ):
        key = (row.language_id, row.clip_id, row.start)
        if key not in newest and not {"tuning", "trial"} & json.loads(row.result).keys():
            newest[key] = row
    columns = [column.name for column in takes.columns]
    op.bulk_insert(
        takes,
        [
            {name: row._mapping[name] for name in columns}
            for row in newest.values()
            if row is not None and row.expected is not None
        ],
    )
