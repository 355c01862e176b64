"""Trains: brake switches against measured stops, by points without couplers."""
