"""Vehicles as data: their description, the built-in ones, parameters with their sources, static loads."""
