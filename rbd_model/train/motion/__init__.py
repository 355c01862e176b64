"""C around the couplers and vehicles of a train: memory, steps, balances."""
