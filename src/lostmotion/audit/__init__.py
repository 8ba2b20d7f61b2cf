"""Many loops: screen, assess, rank, group, follow; on this machine or on a cluster."""
