"""Scenarios of complete vehicles."""
