"""Trains: brake pipes, vehicles and what couples them."""
