"""Scan kernels of the compensating blocks: shared safeguards (core), one kind a module, and what runs them.

The order of a scan is written out in the ``step`` of each kind: PLC code is made from that text, in a language that
cannot hand a function to a function.
"""
