"""Migration: version 0.3.0, with owners of documents, sessions, pairs and invitations."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0011"

_DOCUMENTS = {"language_revision": "document", "recognition": "result"}
_BYTES = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """Make the tables and columns; nobody owns the documents so far."""
    for table, document in _DOCUMENTS.items():
        op.add_column(table, sa.Column("owner", sa.String(80), nullable=False, server_default=""))
        op.add_column(table, sa.Column("size", _BYTES, nullable=False, server_default="0"))
        op.create_index(f"ix_{table}_owner", table, ["owner"])
        # The number of characters: these documents are ASCII but for names.
        op.execute(f"UPDATE {table} SET size = length({document})")
    op.create_table(
        "sign_in",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("name", sa.String(80), nullable=False, index=True),
        sa.Column("proof", sa.String(64), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False, index=True),
    )
    for table in ("labelled_result", "practice_take"):
        op.add_column(table, sa.Column("pair", sa.Text(), nullable=True))
    column = sa.Column("salute_warnings", sa.Text(), nullable=False, server_default="[]")
    op.add_column("job", column)
    op.create_table(
        "invitation",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("language_id", sa.String(32), nullable=False, index=True),
        sa.Column("sha256", sa.String(64), nullable=False, unique=True),
        sa.Column("owner", sa.String(80), nullable=False),
        sa.Column("most_takes", sa.Integer(), nullable=False),
        sa.Column("most_bytes", _BYTES, nullable=False),
        sa.Column("takes", sa.Integer(), nullable=False),
        sa.Column("bytes", _BYTES, nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.Column("expires", sa.DateTime(), nullable=False),
        sa.Column("withdrawn", sa.DateTime(), nullable=True),
        sa.ForeignKeyConstraint(["language_id"], ["language.id"], ondelete="CASCADE"),
    )
    op.create_table(
        "invited_take",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("invitation_id", sa.String(32), nullable=False, index=True),
        sa.Column("clip_id", sa.String(32), nullable=False),
        sa.Column("label", sa.String(200), nullable=False),
        sa.Column("diver", sa.String(80), nullable=False),
        sa.Column("size", _BYTES, nullable=False),
        sa.Column("status", sa.String(16), nullable=False, index=True),
        sa.Column("reason", sa.Text(), nullable=True),
        sa.Column("claimed", sa.DateTime(), nullable=True),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.CheckConstraint(
            "status IN ('waiting', 'added', 'returned')", name="invited_take_status"
        ),
        sa.ForeignKeyConstraint(["invitation_id"], ["invitation.id"], ondelete="CASCADE"),
    )
