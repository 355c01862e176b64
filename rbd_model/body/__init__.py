"""Rigid bodies, how they move, and what connects them."""
