"""Distributors, one file each."""
