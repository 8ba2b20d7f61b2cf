"""What is wrong with a loop: known indices, each of one signal or of OP and PV together."""
