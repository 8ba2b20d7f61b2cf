"""Loops, runs and what they found."""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None

WORDS = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")

PAGE = (
    "run_id newest loop_id window_start verdict severity label split stage kind performance priority size "
    "size_percent excluded_percent confidence probability manual limited missing travel reversals "
    "variability harris period regularity power value"
)


def _columns(kind: Any, optional: bool, names: str) -> list[sa.Column[Any]]:
    return [sa.Column(name, kind, nullable=optional) for name in names.split()]


def upgrade() -> None:
    """Make the tables."""
    _loop()
    _run()
    _assessment()
    _spectrum()
    _trace()
    _unread()
    _oscillation_group()
    _member()


def _loop() -> None:
    op.create_table(
        "loop",
        sa.Column("id", sa.Integer(), primary_key=True, autoincrement=False),
        *_columns(WORDS, False, "tag area type op pv sp mode"),
        *_columns(sa.Text(), True, "op_span pv_span"),
        *_columns(WORDS, False, "op_unit pv_unit"),
        sa.Column("weight", sa.Double(), nullable=False),
        sa.Column("place", WORDS, nullable=False),
        sa.Column("notes", sa.Text(), nullable=False),
        sa.Column("search", WORDS, nullable=False),
    )
    op.create_index("loop_tag", "loop", ["tag"], unique=True)


def _run() -> None:
    op.create_table(
        "run",
        sa.Column("id", sa.Integer(), primary_key=True, autoincrement=False),
        *_columns(WORDS, False, "source settings digest code"),
        *_columns(sa.DateTime(timezone=True), True, "since until"),
        sa.Column("screen_only", sa.Boolean(), nullable=False),
        sa.Column("engine", WORDS, nullable=False),
        sa.Column("workers", sa.BigInteger(), nullable=False),
        sa.Column("state", WORDS, nullable=False),
        *_columns(sa.DateTime(timezone=True), True, "began heartbeat ended"),
        *_columns(WORDS, False, "note coordinator"),
    )


def _assessment() -> None:
    op.create_table(
        "assessment",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), primary_key=True, autoincrement=False),
        sa.Column("window_start", sa.DateTime(timezone=True), primary_key=True),
        sa.Column("window_end", sa.DateTime(timezone=True), nullable=False),
        *_columns(WORDS, False, "fingerprint stamp settings code definition stage reason status verdict kind"),
        *_columns(
            sa.Double(),
            True,
            "size low high size_percent excluded_dead_zone excluded_backlash excluded_stiction "
            "excluded_percent confidence probability",
        ),
        *_columns(WORDS, False, "severity performance label split"),
        sa.Column("priority", sa.Double(), nullable=True),
        sa.Column("priority_reason", WORDS, nullable=False),
        sa.Column("rows", sa.BigInteger(), nullable=False),
        *_columns(
            sa.Double(), True, "dt manual limited missing travel reversals variability harris period regularity power"
        ),
        sa.Column("health", sa.Text(), nullable=False),
        sa.Column("fit_for_use", sa.Boolean(), nullable=False),
        sa.Column("value", sa.Double(), nullable=False),
        sa.Column("why", WORDS, nullable=False),
        *_columns(sa.Text(), False, "advice evidence indices"),
        sa.Column("seconds", sa.Double(), nullable=False),
        sa.Column("error", WORDS, nullable=False),
        sa.Column("screened_in", sa.Integer(), sa.ForeignKey("run.id"), nullable=True),
        sa.Column("assessed_in", sa.Integer(), sa.ForeignKey("run.id"), nullable=True),
        sa.Column("newest", sa.Boolean(), nullable=False),
    )
    op.create_index("assessment_loop", "assessment", ["loop_id", "run_id"])
    op.create_index("assessment_page", "assessment", PAGE.split())
    op.create_index("assessment_priority", "assessment", ["run_id", "priority"])


def _spectrum() -> None:
    op.create_table(
        "spectrum",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), primary_key=True, autoincrement=False),
        sa.Column("window_start", sa.DateTime(timezone=True), primary_key=True),
        *_columns(sa.Double(), False, "low high"),
        sa.Column("power", sa.LargeBinary(), nullable=False),
        *_columns(sa.Double(), True, "nonlinearity op_nonlinearity harmonics phase"),
    )


def _trace() -> None:
    op.create_table(
        "trace",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), primary_key=True, autoincrement=False),
        sa.Column("window_start", sa.DateTime(timezone=True), primary_key=True),
        *_columns(sa.Double(), False, "start seconds"),
        *_columns(sa.LargeBinary(), False, "sp pv op"),
        sa.Column("model", WORDS, nullable=False),
    )


def _unread() -> None:
    op.create_table(
        "unread",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("number", sa.Integer(), primary_key=True, autoincrement=False),
        *_columns(WORDS, False, "place why"),
        sa.Column("failed", sa.Boolean(), nullable=False),
    )


def _oscillation_group() -> None:
    op.create_table(
        "oscillation_group",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("number", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("period", sa.Double(), nullable=False),
        sa.Column("source", WORDS, nullable=False),
        sa.Column("confidence", sa.Double(), nullable=True),
        sa.Column("why", WORDS, nullable=False),
    )


def _member() -> None:
    op.create_table(
        "member",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("number", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("place", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), nullable=False),
        sa.Column("window_start", sa.DateTime(timezone=True), nullable=False),
        *_columns(sa.Double(), False, "likeness score"),
    )
    op.create_index("member_loop", "member", ["loop_id", "run_id"])
