"""Supervisors of many blocks in one process, each from `write = true` in a plant file to its requests."""
