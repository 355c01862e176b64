"""Compares wheel-slide controllers on the test rig: the command `controllers`."""
