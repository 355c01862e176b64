"""Wheelsets on their rails: what all depths of contact share, and a file for each depth."""
