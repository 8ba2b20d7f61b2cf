"""What a diagnosis says of a window, or of a record, as rows of the store."""
