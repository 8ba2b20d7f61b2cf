"""Evidence of many records of one loop: one valve, and process and noise of each record's own."""
