"""The error of control of a whole record: its rows, its spectrum, its oscillation and its amplitude."""
