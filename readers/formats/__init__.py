"""Trains and profiles in files of other programs: a module for each format, which reads it and maps its fields only."""
