"""Maximum likelihood of a Hammerstein model: problem, starts, search, refinement, what the residuals hold."""
