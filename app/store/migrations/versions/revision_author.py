"""Migration: the author of each revision of a language, for the history."""

import json

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"

_revisions = sa.table(
    "language_revision",
    sa.column("language_id", sa.String()),
    sa.column("revision", sa.Integer()),
    sa.column("document", sa.Text()),
    sa.column("author", sa.String()),
)


def upgrade() -> None:
    """Add the column, and fill it from the documents."""
    with op.batch_alter_table("language_revision") as table:
        table.add_column(sa.Column("author", sa.String(200), nullable=False, server_default=""))
    connection = op.get_bind()
    keys = connection.execute(sa.select(_revisions.c.language_id, _revisions.c.revision)).all()
    # One at a time: a document may be megabytes.
    for language_id, number in keys:
        this = (_revisions.c.language_id == language_id) & (_revisions.c.revision == number)
        document = connection.execute(sa.select(_revisions.c.document).where(this)).scalar_one()
        if author := json.loads(document).get("author", ""):
            connection.execute(sa.update(_revisions).where(this).values(author=author))
