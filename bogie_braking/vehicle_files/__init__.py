"""Checks of vehicle files: loads, modes, critical speeds, stops; their figure and page; the command `vehicle`."""
