"""The running plant: a source of `online` over OPC UA, and a supervisor of the block in the PLC.

Names are loaded when they are used: nothing else needs a network.
"""
