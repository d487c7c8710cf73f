"""Migration: the tables of version 0.1.0, of clips, jobs, languages and recognitions."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "clip",
        sa.Column("id", sa.String(length=32), primary_key=True),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("media_type", sa.String(length=64), nullable=False),
        sa.Column("size", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("width", sa.Integer(), nullable=False),
        sa.Column("height", sa.Integer(), nullable=False),
        sa.Column("duration", sa.Float(), nullable=True),
        sa.Column("frames", sa.Integer(), nullable=True),
        sa.Column("topics", sa.Text(), nullable=False, server_default="[]"),
        sa.Column("topic", sa.String(255), nullable=True),
        sa.Column("keypoints", sa.Text(), nullable=True),
        sa.Column("idempotency_key", sa.String(length=255), nullable=True, unique=True),
        sa.Column("created", sa.DateTime(), nullable=False, index=True),
        sa.Column("deleted", sa.DateTime(), nullable=True),
    )

    op.create_table(
        "language",
        sa.Column("id", sa.String(length=32), primary_key=True),
        sa.Column("head", sa.Integer(), nullable=False),
        sa.Column("sample", sa.Boolean(), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False, index=True),
        sa.Column("deleted", sa.DateTime(), nullable=True),
    )

    op.create_table(
        "seeded_sample",
        sa.Column("name", sa.String(length=200), primary_key=True),
        sa.Column("created", sa.DateTime(), nullable=False),
    )
    op.create_table(
        "job",
        sa.Column("id", sa.String(length=32), primary_key=True),
        sa.Column("clip_id", sa.String(length=32), nullable=False, index=True),
        sa.Column("client", sa.String(length=64), nullable=False),
        sa.Column("status", sa.String(length=16), nullable=False, index=True),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("frames", sa.Integer(), nullable=True),
        sa.Column("error_code", sa.String(length=64), nullable=True),
        sa.Column("error", sa.Text(), nullable=True),
        sa.Column("warnings", sa.Text(), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False, index=True),
        sa.Column("started", sa.DateTime(), nullable=True),
        sa.Column("finished", sa.DateTime(), nullable=True),
        sa.CheckConstraint(
            "status IN ('queued', 'running', 'done', 'failed', 'cancelled')", name="job_status"
        ),
        sa.ForeignKeyConstraint(["clip_id"], ["clip.id"], ondelete="CASCADE"),
    )

    op.create_table(
        "language_revision",
        sa.Column("language_id", sa.String(length=32), primary_key=True),
        sa.Column("revision", sa.Integer(), primary_key=True),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("labels", sa.Text(), nullable=False),
        sa.Column("change", sa.String(length=300), nullable=False),
        sa.Column("author", sa.String(200), nullable=False, server_default=""),
        sa.Column("document", sa.Text(), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(["language_id"], ["language.id"], ondelete="CASCADE"),
    )
    op.create_table(
        "recognition",
        sa.Column("id", sa.String(length=32), primary_key=True),
        sa.Column("clip_id", sa.String(length=32), nullable=False, index=True),
        sa.Column("language_id", sa.String(length=32), nullable=False, index=True),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("start", sa.Float(), nullable=False),
        sa.Column("end", sa.Float(), nullable=False),
        sa.Column("profile", sa.String(length=32), nullable=False),
        sa.Column("expected", sa.String(length=200), nullable=True),
        sa.Column("result", sa.Text(), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False, index=True),
        sa.ForeignKeyConstraint(["clip_id"], ["clip.id"], ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["language_id"], ["language.id"], ondelete="CASCADE"),
    )
    op.create_table(
        "demonstration_source",
        sa.Column("trajectory", sa.String(64), primary_key=True),
        sa.Column("clip_id", sa.String(32), nullable=False, index=True),
        sa.Column("start", sa.Float(), nullable=False),
        sa.Column("end", sa.Float(), nullable=False),
        sa.Column("keep_transit", sa.Boolean(), nullable=False),
        sa.ForeignKeyConstraint(["clip_id"], ["clip.id"], ondelete="CASCADE"),
    )
