"""What is new in a run, written down when it ends."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"

WORDS = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")


def upgrade() -> None:
    """Make the tables; of runs that have ended it is worked out when it is asked for."""
    op.create_table(
        "comparison",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("earlier_id", sa.Integer(), sa.ForeignKey("run.id"), nullable=False),
    )
    words = ("what", "before", "after", "severity_before", "severity_after")
    op.create_table(
        "change",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("place", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), nullable=False),
        *(sa.Column(name, WORDS, nullable=False) for name in words),
    )
