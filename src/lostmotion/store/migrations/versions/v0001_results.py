"""Loops, runs and what they found."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None

WORDS = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")


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
        sa.Column("tag", WORDS, nullable=False),
        sa.Column("area", WORDS, nullable=False),
        sa.Column("type", WORDS, nullable=False),
        sa.Column("op", WORDS, nullable=False),
        sa.Column("pv", WORDS, nullable=False),
        sa.Column("sp", WORDS, nullable=False),
        sa.Column("mode", WORDS, nullable=False),
        sa.Column("op_span", sa.Text(), nullable=True),
        sa.Column("pv_span", sa.Text(), nullable=True),
        sa.Column("op_unit", WORDS, nullable=False),
        sa.Column("pv_unit", WORDS, nullable=False),
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
        sa.Column("source", WORDS, nullable=False),
        sa.Column("settings", WORDS, nullable=False),
        sa.Column("digest", WORDS, nullable=False),
        sa.Column("code", WORDS, nullable=False),
        sa.Column("since", sa.DateTime(timezone=True), nullable=True),
        sa.Column("until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("screen_only", sa.Boolean(), nullable=False),
        sa.Column("engine", WORDS, nullable=False),
        sa.Column("workers", sa.BigInteger(), nullable=False),
        sa.Column("state", WORDS, nullable=False),
        sa.Column("began", sa.DateTime(timezone=True), nullable=True),
        sa.Column("heartbeat", sa.DateTime(timezone=True), nullable=True),
        sa.Column("ended", sa.DateTime(timezone=True), nullable=True),
        sa.Column("note", WORDS, nullable=False),
        sa.Column("coordinator", WORDS, nullable=False),
    )


def _assessment() -> None:
    op.create_table(
        "assessment",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), primary_key=True, autoincrement=False),
        sa.Column("window_start", sa.DateTime(timezone=True), primary_key=True),
        sa.Column("window_end", sa.DateTime(timezone=True), nullable=False),
        sa.Column("fingerprint", WORDS, nullable=False),
        sa.Column("stamp", WORDS, nullable=False),
        sa.Column("settings", WORDS, nullable=False),
        sa.Column("code", WORDS, nullable=False),
        sa.Column("definition", WORDS, nullable=False),
        sa.Column("stage", WORDS, nullable=False),
        sa.Column("reason", WORDS, nullable=False),
        sa.Column("status", WORDS, nullable=False),
        sa.Column("verdict", WORDS, nullable=False),
        sa.Column("kind", WORDS, nullable=False),
        sa.Column("size", sa.Double(), nullable=True),
        sa.Column("low", sa.Double(), nullable=True),
        sa.Column("high", sa.Double(), nullable=True),
        sa.Column("size_percent", sa.Double(), nullable=True),
        sa.Column("excluded_dead_zone", sa.Double(), nullable=True),
        sa.Column("excluded_backlash", sa.Double(), nullable=True),
        sa.Column("excluded_stiction", sa.Double(), nullable=True),
        sa.Column("excluded_percent", sa.Double(), nullable=True),
        sa.Column("confidence", sa.Double(), nullable=True),
        sa.Column("probability", sa.Double(), nullable=True),
        sa.Column("severity", WORDS, nullable=False),
        sa.Column("performance", WORDS, nullable=False),
        sa.Column("label", WORDS, nullable=False),
        sa.Column("split", WORDS, nullable=False),
        sa.Column("priority", sa.Double(), nullable=True),
        sa.Column("priority_reason", WORDS, nullable=False),
        sa.Column("rows", sa.BigInteger(), nullable=False),
        sa.Column("dt", sa.Double(), nullable=True),
        sa.Column("manual", sa.Double(), nullable=True),
        sa.Column("limited", sa.Double(), nullable=True),
        sa.Column("missing", sa.Double(), nullable=True),
        sa.Column("travel", sa.Double(), nullable=True),
        sa.Column("reversals", sa.Double(), nullable=True),
        sa.Column("variability", sa.Double(), nullable=True),
        sa.Column("harris", sa.Double(), nullable=True),
        sa.Column("period", sa.Double(), nullable=True),
        sa.Column("regularity", sa.Double(), nullable=True),
        sa.Column("power", sa.Double(), nullable=True),
        sa.Column("health", sa.Text(), nullable=False),
        sa.Column("fit_for_use", sa.Boolean(), nullable=False),
        sa.Column("value", sa.Double(), nullable=False),
        sa.Column("why", WORDS, nullable=False),
        sa.Column("advice", sa.Text(), nullable=False),
        sa.Column("evidence", sa.Text(), nullable=False),
        sa.Column("indices", sa.Text(), nullable=False),
        sa.Column("seconds", sa.Double(), nullable=False),
        sa.Column("error", WORDS, nullable=False),
        sa.Column("screened_in", sa.Integer(), sa.ForeignKey("run.id"), nullable=True),
        sa.Column("assessed_in", sa.Integer(), sa.ForeignKey("run.id"), nullable=True),
        sa.Column("newest", sa.Boolean(), nullable=False),
    )
    op.create_index("assessment_loop", "assessment", ["loop_id", "run_id"])
    op.create_index(
        "assessment_page",
        "assessment",
        [
            "run_id",
            "newest",
            "loop_id",
            "window_start",
            "verdict",
            "severity",
            "label",
            "split",
            "stage",
            "kind",
            "performance",
            "priority",
            "size",
            "size_percent",
            "excluded_percent",
            "confidence",
            "probability",
            "manual",
            "limited",
            "missing",
            "travel",
            "reversals",
            "variability",
            "harris",
            "period",
            "regularity",
            "power",
            "value",
        ],
    )
    op.create_index("assessment_priority", "assessment", ["run_id", "priority"])


def _spectrum() -> None:
    op.create_table(
        "spectrum",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), primary_key=True, autoincrement=False),
        sa.Column("window_start", sa.DateTime(timezone=True), primary_key=True),
        sa.Column("low", sa.Double(), nullable=False),
        sa.Column("high", sa.Double(), nullable=False),
        sa.Column("power", sa.LargeBinary(), nullable=False),
        sa.Column("nonlinearity", sa.Double(), nullable=True),
        sa.Column("op_nonlinearity", sa.Double(), nullable=True),
        sa.Column("harmonics", sa.Double(), nullable=True),
        sa.Column("phase", sa.Double(), nullable=True),
    )


def _trace() -> None:
    op.create_table(
        "trace",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("loop_id", sa.Integer(), sa.ForeignKey("loop.id"), primary_key=True, autoincrement=False),
        sa.Column("window_start", sa.DateTime(timezone=True), primary_key=True),
        sa.Column("start", sa.Double(), nullable=False),
        sa.Column("seconds", sa.Double(), nullable=False),
        sa.Column("sp", sa.LargeBinary(), nullable=False),
        sa.Column("pv", sa.LargeBinary(), nullable=False),
        sa.Column("op", sa.LargeBinary(), nullable=False),
        sa.Column("model", WORDS, nullable=False),
    )


def _unread() -> None:
    op.create_table(
        "unread",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("run.id"), primary_key=True, autoincrement=False),
        sa.Column("number", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("place", WORDS, nullable=False),
        sa.Column("why", WORDS, nullable=False),
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
        sa.Column("likeness", sa.Double(), nullable=False),
        sa.Column("score", sa.Double(), nullable=False),
    )
    op.create_index("member_loop", "member", ["loop_id", "run_id"])
