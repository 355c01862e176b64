"""Wheel-slide controllers compared on the test rig: the command `controllers`."""
