"""Parts of benchmarks/eastman.py."""
