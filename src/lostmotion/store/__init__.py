"""Results of audits in SQL: rows, tables, what is written and what is asked."""
