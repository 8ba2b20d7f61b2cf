"""An OPC UA server that is not ours, and certificates of every kind, for the tests of the live link."""
