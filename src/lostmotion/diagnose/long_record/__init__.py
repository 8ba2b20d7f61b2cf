"""A long record: the valve by its most informative stretches."""
