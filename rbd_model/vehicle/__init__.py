"""Vehicles as data: their description, the ready ones, parameters with their sources, what rests on what."""
