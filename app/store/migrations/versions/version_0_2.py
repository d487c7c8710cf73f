"""Migration: version 0.2.0, with owners, test sets, practice, several servers and uploads."""

import json

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0005"

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
    """Make the tables and columns.

    The source of each clip follows from its columns. Recognitions that served as the test until
    now become the test set.
    """
    op.add_column(
        "clip", sa.Column("source", sa.String(16), nullable=False, server_default="video")
    )
    # Not in a batch: SQLite would recreate the table, and the jobs refer to it.
    op.execute("ALTER TABLE clip RENAME COLUMN keypoints TO options")
    op.execute("UPDATE clip SET source = 'bag' WHERE topics <> '[]'")
    op.execute("UPDATE clip SET source = 'keypoints' WHERE options IS NOT NULL")
    op.add_column("clip", sa.Column("owner", sa.String(80), nullable=False, server_default=""))
    op.create_index("ix_clip_owner", "clip", ["owner"])
    op.create_table(
        "audit_entry",
        sa.Column("id", sa.Integer(), primary_key=True),
        sa.Column("time", sa.DateTime(), nullable=False),
        sa.Column("name", sa.String(80), nullable=False, index=True),
        sa.Column("role", sa.String(16), nullable=False),
        sa.Column("address", sa.String(64), nullable=False),
        sa.Column("method", sa.String(16), nullable=False),
        sa.Column("path", sa.String(300), nullable=False),
        sa.Column("status", sa.Integer(), nullable=False),
        sa.Column("request_id", sa.String(64), nullable=False),
    )
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
    op.add_column("job", sa.Column("server", sa.String(32), nullable=True))
    op.add_column("job", sa.Column("lease", sa.DateTime(), nullable=True))
    count = op.create_table(
        "change_count",
        sa.Column("id", sa.Integer(), primary_key=True),
        sa.Column("changes", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
    )
    op.bulk_insert(count, [{"id": 1, "changes": 0}])
    op.create_table(
        "upload_reservation",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("owner", sa.String(80), nullable=False, index=True),
        sa.Column("size", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("touched", sa.DateTime(), nullable=False),
    )
