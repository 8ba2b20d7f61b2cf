"""A long record: the valve by its most telling stretches."""
