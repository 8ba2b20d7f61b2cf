"""What is watched on a running plant, and its estimates."""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"

WORDS = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")


def _columns(kind: Any, optional: bool, names: str) -> list[sa.Column[Any]]:
    return [sa.Column(name, kind, nullable=optional) for name in names.split()]


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "watch",
        sa.Column("id", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("source", WORDS, nullable=False),
        sa.Column("tags", sa.Text(), nullable=False),
        *_columns(WORDS, False, "digest state"),
        *_columns(sa.DateTime(timezone=True), True, "began heartbeat ended"),
        *_columns(WORDS, False, "note coordinator"),
    )
    op.create_table(
        "estimate",
        sa.Column("watch_id", sa.Integer(), sa.ForeignKey("watch.id"), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), primary_key=True, autoincrement=False),
        sa.Column("at", sa.DateTime(timezone=True), primary_key=True),
        sa.Column("sample", sa.BigInteger(), nullable=False),
        sa.Column("status", WORDS, nullable=False),
        sa.Column("width", sa.Double(), nullable=False),
        *_columns(sa.Double(), True, "low high standard_error left right"),
    )
    op.create_index("estimate_loop", "estimate", ["loop_id", "at"])
