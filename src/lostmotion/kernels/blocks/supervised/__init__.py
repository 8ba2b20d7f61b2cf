"""Compensating blocks that take their widths from a supervisor, each with a person's word: one kind a module."""
