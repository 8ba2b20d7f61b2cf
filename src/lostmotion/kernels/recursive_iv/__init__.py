"""Recursive instrumental variables: where the state lies, what a sample does to it, and the run through samples."""
