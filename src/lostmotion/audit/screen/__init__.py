"""Every loop and window in milliseconds: what its data are worth, how it controls, whether it swings."""
