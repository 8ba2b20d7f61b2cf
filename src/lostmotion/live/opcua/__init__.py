"""OPC UA as a source of `online`: one connection, many loops."""
