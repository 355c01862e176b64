"""C of trains: loops over cells, distributors, brakes, vehicles and couplers, what joins them, and the FMUs."""
