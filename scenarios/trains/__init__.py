"""Trains: how far they run until they stand."""
