"""Dropped files and what became of them."""
