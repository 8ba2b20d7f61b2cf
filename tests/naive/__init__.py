"""Slow, obvious twins of the kernels: plain loops, written from the equations."""
