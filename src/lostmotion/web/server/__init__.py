"""Socket, token, limits of time."""
