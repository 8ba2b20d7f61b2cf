"""Parts of benchmarks/online.py."""
