"""C that composes brake pipe, distributors, brakes, vehicles and couplers to a train, and its FMU."""
