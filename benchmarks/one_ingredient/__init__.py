"""Loops of a base case with one ingredient changed at a time, and how their diagnosis is judged."""
