"""Loops that swing together, and where it comes from."""
