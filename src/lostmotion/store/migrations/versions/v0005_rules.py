"""The rule that decides about a loop, as a column of its own."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"

WORDS = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")
PAGE = (
    "run_id newest loop_id window_start verdict rule severity label split stage kind performance priority size "
    "size_percent excluded_percent confidence probability manual limited missing travel reversals "
    "variability harris period regularity power value"
)
OPENS = {  # first words of the reason of a priority, until then the only trace of its rule
    "PV stood still": "frozen measurement",
    "PV scatters over": "noisy measurement",
    "hardly settles: retune": "ringing",
    "OP travels": "wear by travel",
}
STANDS = {"its amplitude stays: not its tuning": "forced swing"}  # a part of the reason, anywhere


def upgrade() -> None:
    """Add the column, filled from the reasons, and have it in the index of pages."""
    op.add_column("assessment", sa.Column("rule", WORDS, nullable=False, server_default=""))
    table = sa.table("assessment", *(sa.column(name) for name in ("rule", "priority", "priority_reason")))
    reason, connection = table.c.priority_reason, op.get_bind()
    known = [(reason.startswith(words), name) for words, name in OPENS.items()]
    known += [((sa.literal("; ") + reason + "; ").contains(f"; {words}; "), name) for words, name in STANDS.items()]
    ruled = table.c.priority.is_not(None) & sa.or_(*(condition for condition, _ in known))
    connection.execute(table.update().where(ruled).values(rule=sa.case(*known, else_="")))
    op.drop_index("assessment_page", "assessment")
    op.create_index("assessment_page", "assessment", PAGE.split())
