"""Wheelsets on their rails: common parts of all contact models, and a file for each model."""
