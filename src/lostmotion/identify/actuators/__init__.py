"""Kinds of actuator: where each is sought, how fits of several compare, what acts beside them."""
