"""How values of the schema are handed to a database."""

from datetime import UTC, datetime, timedelta, timezone

from sqlalchemy.dialects import postgresql, sqlite

from lostmotion.store.schema import Utc


def test_a_moment_has_its_zone_where_the_database_has_zones():
    """PostgreSQL would take one without a zone for a moment of the zone of its session."""
    at = datetime(2026, 3, 1, 14, 0, tzinfo=timezone(timedelta(hours=2)))
    assert Utc().process_bind_param(at, sqlite.dialect()) == datetime(2026, 3, 1, 12, 0)
    assert Utc().process_bind_param(at, postgresql.dialect()) == datetime(2026, 3, 1, 12, 0, tzinfo=UTC)
