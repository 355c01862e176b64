"""Trains: brake pipe, couplers, stopping distances."""
