"""Migrations of the store, run by alembic: one file a version in versions/."""
