"""Estimation sample by sample: instrumental variables (the paper) and maximum likelihood."""
