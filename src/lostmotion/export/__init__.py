"""Code for PLCs from the same kernels that are simulated."""
