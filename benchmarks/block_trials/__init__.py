"""Simulated loops that a block is made for and then tried on."""
