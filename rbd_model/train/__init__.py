"""Trains: couplers, and the motion of vehicles along the track, each a mass with wheels that roll or slide."""
