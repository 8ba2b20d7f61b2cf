"""Simulated signals, plants and loops."""
