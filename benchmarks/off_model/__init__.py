"""Real motors, and plants that are not quite of the model's shape: see ``python -m benchmarks.off_model --help``."""
