"""What running monitors report."""
