"""Migration: owner and size of each revision and recognition, which count towards quotas."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"

_DOCUMENTS = {"language_revision": "document", "recognition": "result"}
_BYTES = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """Add the columns; nobody owns what there is so far."""
    for table, document in _DOCUMENTS.items():
        op.add_column(table, sa.Column("owner", sa.String(80), nullable=False, server_default=""))
        op.add_column(table, sa.Column("size", _BYTES, nullable=False, server_default="0"))
        op.create_index(f"ix_{table}_owner", table, ["owner"])
        # The number of characters: these documents are ASCII but for names.
        op.execute(f"UPDATE {table} SET size = length({document})")
