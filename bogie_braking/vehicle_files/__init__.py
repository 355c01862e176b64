"""Checks of vehicle files: loads, modes, critical speed, stops; their picture and page; the command `vehicle`."""
