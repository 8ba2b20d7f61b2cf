"""What alembic runs: the migrations in the connection that it is given."""

from alembic import context

if __name__ == "env_py":  # as alembic calls it; tests of the documentation import every module
    context.configure(connection=context.config.attributes["connection"], version_table="schema_version")
    context.run_migrations()
