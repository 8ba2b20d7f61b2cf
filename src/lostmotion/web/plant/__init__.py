"""A plant from its store: ranking, loops, reviews, JSON."""
