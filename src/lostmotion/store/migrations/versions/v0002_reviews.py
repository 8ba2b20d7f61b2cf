"""What people decide about findings."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"

WORDS = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "review",
        sa.Column("id", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), nullable=False),
        sa.Column("state", WORDS, nullable=False),
        sa.Column("who", WORDS, nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("note", WORDS, nullable=False),
    )
    op.create_index("review_loop", "review", ["loop_id", "id"])
