"""What alembic runs: the migrations in the connection that it is given."""

from alembic import context

context.configure(connection=context.config.attributes["connection"], version_table="schema_version")
context.run_migrations()
